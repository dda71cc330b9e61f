//! Compares light in the voxels with closed forms, and checks energy conservation.
//!
//! All numbers are face radiances of the voxel list, so these tests cover injection, filter, cones
//! and bounces at once, without a picture.

use std::f32::consts::PI;

use glam::{EulerRot, Mat4, Quat, Vec3};

use crate::gpu::{Pipelines, Recorder, Timing};
use crate::testing::{SceneBuilder, busy_room, device, lambert, read};
use crate::voxels::FaceRecord;
use crate::{
    Geometry, Gi, GiConfig, Gloss, Grid, Light, LightSource, Preset, Shadow, TraceSettings,
};

/// Faces with the radiance that they send out.
struct Lit {
    faces: Vec<(FaceRecord, Vec3)>,
}

impl Lit {
    /// Mean radiance (red) of the faces that the filter lets through.
    fn mean(&self, filter: impl Fn(&FaceRecord) -> bool) -> f32 {
        let chosen: Vec<f32> =
            self.faces.iter().filter(|(face, _)| filter(face)).map(|(_, r)| r.x).collect();
        assert!(!chosen.is_empty(), "no face was chosen");
        chosen.iter().sum::<f32>() / chosen.len() as f32
    }
}

struct Bench {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
}

impl Bench {
    fn new(bounds: (Vec3, Vec3), resolution: u32, offset: Vec3, scene: SceneBuilder) -> Self {
        let (device, queue) = device();
        let grid = Grid::fit(bounds.0, bounds.1, resolution, offset).expect("the grid fits");
        let config = GiConfig::new(grid);
        let mut gi =
            Gi::with_pipelines(&device, &queue, config).expect("the device is large enough");
        let geometry: Geometry = scene.build(&device);
        pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
        Self { device, queue, gi }
    }

    /// The faces with their light; `bounces` counts gathers as `Gi::light` does.
    fn light(&mut self, lights: &[Light], environment: Vec3, bounces: u32) -> Lit {
        self.light_with(lights, environment, bounces, Preset::Balanced)
    }

    fn light_with(
        &mut self,
        lights: &[Light],
        environment: Vec3,
        bounces: u32,
        preset: Preset,
    ) -> Lit {
        let settings = TraceSettings::preset(preset);
        let lights = self.gi.bind_lights(lights, environment, None);
        let mut recorder = Recorder::new(&self.device, &self.queue);
        self.gi.light(&mut recorder, &lights, bounces, &settings).expect("valid settings");
        recorder.submit();
        let voxels = self.gi.voxels().expect("there are voxels");
        let count = voxels.face_count as usize;
        let faces: Vec<FaceRecord> = read(&self.device, &self.queue, &voxels.faces, count);
        let buffer = self.gi.face_radiance().expect("there is light");
        let radiance: Vec<[f32; 4]> = read(&self.device, &self.queue, buffer, count);
        let radiance = radiance.iter().map(|r| Vec3::new(r[0], r[1], r[2]));
        Lit { faces: faces.into_iter().zip(radiance).collect() }
    }
}

/// A point light of 1 cd in each channel.
fn candle(position: Vec3, shadow: Shadow) -> Light {
    let source =
        LightSource::Point { position, intensity: Vec3::ONE, radius_m: 0.0, range_m: None };
    Light { source, shadow }
}

/// In a closed box that emits e and reflects the share r everywhere, the radiance is e / (1 - r)
/// everywhere.
#[test]
#[ignore = "slow: over three seconds"]
fn furnace_converges_to_its_closed_form() {
    let bounds = (Vec3::ZERO, Vec3::ONE);
    let room = SceneBuilder::default().room(bounds.0, bounds.1, &lambert(0.5, 1.0));
    let mut bench = Bench::new(bounds, 64, Vec3::ZERO, room);
    let mut last = 0.0;
    let mut increase = f32::INFINITY;
    for bounces in 1..8 {
        let mean = bench.light(&[], Vec3::ZERO, bounces).mean(|_| true);
        // Each bounce adds less than the one before it: energy decays.
        assert!(
            mean - last < 0.6 * increase,
            "bounce {bounces} adds {} after {increase}",
            mean - last
        );
        assert!(mean >= last, "bounce {bounces} takes light away: {mean} after {last}");
        increase = mean - last;
        last = mean;
    }
    // The gathers of more bounces are accelerated.
    let last = bench.light(&[], Vec3::ZERO, 10).mean(|_| true);
    // A gather at 64 voxels misses 2 % (oblique walls are sampled unevenly, and near corners cones
    // start inside the neighbour's voxels). The bounces compound it: e / (1 - 0.98 r) = 1.96.
    let high = bench.light_with(&[], Vec3::ZERO, 10, Preset::High).mean(|_| true);
    println!("furnace: {last}, high {high}, of 2");
    assert!((1.94..2.02).contains(&last), "the furnace glows with {last}, not 2");
    assert!((1.94..2.02).contains(&high), "with the high preset it glows with {high}, not 2");
}

/// Walls oblique to the grid leak no more than walls along it: a turned box. A gather of e = 1 by
/// surfaces that reflect one half adds one half.
#[test]
fn a_rotated_furnace_leaks_no_light() {
    for angles in [[0.5, 0.35, 0.4], [0.17, 0.61, 0.09], [0.3, -0.58, 0.89]] {
        let turn = Quat::from_euler(EulerRot::XYZ, angles[0], angles[1], angles[2]);
        let corner = Vec3::splat(0.5);
        let room = SceneBuilder::default().room(-corner, corner, &lambert(0.5, 1.0));
        let bounds = (Vec3::splat(-0.85), Vec3::splat(0.85));
        let room = room.transformed(Mat4::from_quat(turn));
        let mut bench = Bench::new(bounds, 64, Vec3::ZERO, room);
        let lit = bench.light_with(&[], Vec3::ZERO, 2, Preset::High);
        let gathered = 2.0 * (lit.mean(|_| true) - 1.0);
        println!("turned by {angles:?}: a gather finds {gathered} of 1");
        assert!((gathered - 1.0).abs() < 0.05, "a gather finds {gathered}, not 1");
    }
}

/// A face is never darker than black.
#[test]
fn no_face_has_negative_radiance() {
    let corner = Vec3::splat(0.5);
    let room = SceneBuilder::default().room(-corner, corner, &lambert(0.5, 0.0));
    let turn = Quat::from_euler(EulerRot::XYZ, 0.5, 0.35, 0.4);
    let bounds = (Vec3::splat(-0.85), Vec3::splat(0.85));
    let room = room.transformed(Mat4::from_quat(turn));
    let mut bench = Bench::new(bounds, 64, Vec3::ZERO, room);
    let lit = bench.light(&[], Vec3::splat(100.0), 2);
    let least = lit.faces.iter().map(|(_, radiance)| radiance.min_element());
    let least = least.fold(f32::INFINITY, f32::min);
    assert!(least >= 0.0, "a face sends out {least}");
    let black = lit.faces.iter().filter(|(_, radiance)| radiance.x <= 0.0).count();
    assert!(black > 100, "only {black} faces are black");
}

/// E = L / 2 pi * sum of (a / sqrt(1 + a^2) * atan(b / sqrt(1 + a^2)) + ...) for each quarter of a
/// rectangle above a point, parallel to it: Howell, "A catalog of radiation heat transfer
/// configuration factors", B-4.
fn rectangle_above(point: Vec3, corner: Vec3, size_x: f32, size_z: f32, radiance: f32) -> f32 {
    let height = corner.y - point.y;
    let quarter = |x: f32, z: f32| {
        let (a, b) = (x.abs() / height, z.abs() / height);
        let (ra, rb) = ((1.0 + a * a).sqrt(), (1.0 + b * b).sqrt());
        let factor = (a / ra * (b / ra).atan() + b / rb * (a / rb).atan()) / (2.0 * PI);
        factor * x.signum() * z.signum()
    };
    let (x0, x1) = (corner.x - point.x, corner.x + size_x - point.x);
    let (z0, z1) = (corner.z - point.z, corner.z + size_z - point.z);
    PI * radiance * (quarter(x1, z1) - quarter(x0, z1) - quarter(x1, z0) + quarter(x0, z0))
}

#[test]
fn panel_lights_the_floor_by_its_form_factor() {
    let (corner, size) = (Vec3::new(-1.0, 1.0, -1.0), 2.0);
    let scene = SceneBuilder::default()
        .quad(corner, Vec3::X * size, Vec3::Z * size, lambert(0.0, 1.0))
        .quad(Vec3::new(-1.5, 0.0, -1.5), Vec3::Z * 3.0, Vec3::X * 3.0, lambert(0.5, 0.0));
    let bounds = (Vec3::new(-1.5, 0.0, -1.5), Vec3::new(1.5, 1.0, 1.5));
    let mut bench = Bench::new(bounds, 64, Vec3::ZERO, scene);
    let lit = bench.light(&[], Vec3::ZERO, 2);
    let (mut sum, mut expected_sum, mut squares, mut count) = (0.0, 0.0, 0.0, 0);
    for (face, radiance) in lit.faces.iter().filter(|(face, _)| face.position_in_world[1] < 0.5) {
        let point = Vec3::from(face.position_in_world);
        let expected = 0.5 / PI * rectangle_above(point, corner, size, size, 1.0);
        sum += radiance.x;
        expected_sum += expected;
        squares += (radiance.x - expected).powi(2);
        count += 1;
    }
    let bias = sum / expected_sum - 1.0;
    let rmse = (squares / count as f32).sqrt() / (expected_sum / count as f32);
    println!("panel: bias {:.1} %, RMSE {:.1} %", 100.0 * bias, 100.0 * rmse);
    assert!(bias.abs() < 0.05, "bias {bias}");
    // One jittered direction per cell and no mean over frames: the noise of single cones.
    assert!(rmse < 0.75, "relative RMSE {rmse}");
}

/// Direct light is exact: a face holds reflectance / pi * I * cos / d^2 of its own position.
#[test]
fn direct_light_follows_the_inverse_square() {
    let bounds = (Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9));
    let mut bench = Bench::new(bounds, 32, Vec3::ZERO, busy_room());
    let place = Vec3::new(0.5, 0.4, 0.6);
    let lit = bench.light(&[candle(place, Shadow::None)], Vec3::ZERO, 1);
    for (face, radiance) in &lit.faces {
        let to_light = place - Vec3::from(face.position_in_world);
        let normal = Vec3::from(face.vector_area).normalize();
        let squared = to_light.length_squared().max(1e-6);
        let cosine = normal.dot(to_light / squared.sqrt()).max(0.0);
        let expected =
            Vec3::from(face.emission) + Vec3::from(face.reflectance) / PI * (cosine / squared);
        let error = (*radiance - expected).abs().max_element();
        assert!(
            error <= 1e-4 * (1.0 + expected.max_element()),
            "{face:?}: {radiance}, not {expected}"
        );
    }
}

/// Lamps end at their range, by a window of the fourth power, and spot lights fade between their
/// two angles as the square: `KHR_lights_punctual`, sections "Range Property" and "Inner and Outer
/// Cone Angles".
#[test]
fn lamp_ranges_and_spot_cones_follow_gltf() {
    let bounds = (Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9));
    let mut bench = Bench::new(bounds, 32, Vec3::ZERO, busy_room());
    let (position, range_m) = (Vec3::new(0.5, 0.4, 0.6), 0.5);
    let (inner_angle_rad, outer_angle_rad) = (0.4_f32, 0.9_f32);
    let direction = Vec3::new(0.3, -1.0, 0.2).normalize();
    let (intensity, radius_m) = (Vec3::ONE, 0.0);
    let ending = LightSource::Point { position, intensity, radius_m, range_m: Some(range_m) };
    let spot = LightSource::Spot {
        position,
        direction,
        intensity,
        inner_angle_rad,
        outer_angle_rad,
        radius_m,
        range_m: None,
    };
    let window = |to_light: Vec3| 1.0 - (to_light.length() / range_m).powi(4);
    let cone = |to_light: Vec3| {
        let (inner, outer) = (inner_angle_rad.cos(), outer_angle_rad.cos());
        let share = (direction.dot(-to_light.normalize()) - outer) / (inner - outer);
        share.clamp(0.0, 1.0).powi(2)
    };
    let dark = bench.light(&[], Vec3::ZERO, 1);
    let whole = bench.light(&[candle(position, Shadow::None)], Vec3::ZERO, 1);
    for (source, share) in [(ending, &window as &dyn Fn(Vec3) -> f32), (spot, &cone)] {
        let lit = bench.light(&[Light { source, shadow: Shadow::None }], Vec3::ZERO, 1);
        let (mut partly, mut most) = (0, 0.0_f32);
        for (((face, lit), (_, whole)), (_, dark)) in
            lit.faces.iter().zip(&whole.faces).zip(&dark.faces)
        {
            let expected = share(position - Vec3::from(face.position_in_world)).max(0.0);
            let (lit, whole) = (*lit - *dark, *whole - *dark);
            let error = (lit - expected * whole).abs().max_element();
            assert!(error <= 1e-4 * (1.0 + whole.max_element()), "{face:?}: {lit} of {whole}");
            partly += usize::from(expected > 0.1 && expected < 0.9 && whole.max_element() > 0.01);
            most = most.max(expected);
        }
        assert!(partly > 100 && most > 0.9, "{source:?}: {partly} faces lie in between, {most}");
    }
}

/// A plate between the light and the floor: dark below it, full light beside it, nothing from the
/// plate's own surroundings.
#[test]
fn cone_shadow_falls_below_the_plate() {
    let plate = crate::SurfaceMaterial { double_sided: true, ..lambert(0.0, 0.0) };
    let scene = SceneBuilder::default().quad(Vec3::ZERO, Vec3::Z, Vec3::X, lambert(0.5, 0.0)).quad(
        Vec3::new(0.35, 0.5, 0.35),
        Vec3::X * 0.3,
        Vec3::Z * 0.3,
        plate,
    );
    let bounds = (Vec3::ZERO, Vec3::ONE);
    let mut bench = Bench::new(bounds, 64, Vec3::ZERO, scene);
    let place = Vec3::new(0.5, 0.95, 0.5);
    let shadowed = bench.light(&[candle(place, Shadow::Cone)], Vec3::ZERO, 1);
    let open = bench.light(&[candle(place, Shadow::None)], Vec3::ZERO, 1);
    // The plate's edge, seen from the light, falls on the floor 0.32 m from the centre.
    let at = |face: &FaceRecord, low: f32, high: f32| {
        let [x, y, z] = face.position_in_world;
        let off = (x - 0.5).abs().max((z - 0.5).abs());
        y < 0.1 && (low..high).contains(&off)
    };
    let share = |low, high| shadowed.mean(|f| at(f, low, high)) / open.mean(|f| at(f, low, high));
    assert!(share(0.0, 0.25) < 0.01, "light below the plate: {}", share(0.0, 0.25));
    assert!(share(0.42, 0.5) > 0.99, "the floor shadows itself: {}", share(0.42, 0.5));
}

/// The sky lights an open floor with pi times its radiance.
#[test]
fn an_open_floor_gets_pi_times_sky_radiance() {
    let scene = SceneBuilder::default().quad(Vec3::ZERO, Vec3::Z, Vec3::X, lambert(0.5, 0.0));
    let mut bench = Bench::new((Vec3::ZERO, Vec3::new(1.0, 0.2, 1.0)), 32, Vec3::ZERO, scene);
    let mean = bench.light(&[], Vec3::splat(3.0), 2).mean(|_| true);
    assert!(
        (mean - 1.5).abs() < 1e-3,
        "a floor of 50 % under a sky of 3 sends out {mean}, not 1.5"
    );
}

/// The radiance of lacquered faces includes mirrored light: for a sky the mean over angles, for a
/// lamp the value at its angle.
#[test]
fn radiance_of_lacquered_faces_includes_mirrored_light() {
    let gloss = Gloss { mean: 0.08, grazing: 0.6, kept_out: 0.04 };
    let floor = |gloss| {
        let material = crate::SurfaceMaterial { gloss, ..lambert(0.5, 0.0) };
        let scene = SceneBuilder::default().quad(Vec3::ZERO, Vec3::Z, Vec3::X, material);
        Bench::new((Vec3::ZERO, Vec3::new(1.0, 0.5, 1.0)), 32, Vec3::ZERO, scene)
    };
    let (mut plain, mut lacquered) = (floor(Gloss::NONE), floor(gloss));
    let mean = lacquered.light(&[], Vec3::splat(3.0), 2).mean(|_| true);
    let expected = 3.0 * (0.5 * 0.96 + 0.08);
    assert!((mean - expected).abs() < 1e-3, "under the sky it sends out {mean}, not {expected}");

    let place = Vec3::new(0.1, 0.3, 0.5);
    let light = [candle(place, Shadow::None)];
    let (plain, lacquered) =
        (plain.light(&light, Vec3::ZERO, 0), lacquered.light(&light, Vec3::ZERO, 0));
    let mut steepest = 1.0_f32;
    for ((face, of_plain), (_, of_lacquer)) in plain.faces.iter().zip(&lacquered.faces) {
        let to_light = place - Vec3::from(face.position_in_world);
        let cosine = to_light.normalize().y;
        let share = 0.5 * 0.96 + 0.08 + 0.6 * ((1.0 - cosine).powi(4) - 1.0 / 15.0);
        let error = of_lacquer.x / of_plain.x - share / 0.5;
        assert!(error.abs() < 1e-3, "at {cosine}: {} of {}", of_lacquer.x, of_plain.x);
        steepest = steepest.min(cosine);
    }
    assert!(steepest < 0.35, "the lamp stands no lower than {steepest}");
}

/// A closed room from the origin to a corner, with walls of a thickness, under a sky of radiance 1.
fn closed_room(high: Vec3, wall: f32, resolution: u32, offset: Vec3) -> Lit {
    let white = lambert(0.5, 0.0);
    let (low, x, y, z) = (Vec3::ZERO, high * Vec3::X, high * Vec3::Y, high * Vec3::Z);
    let outside =
        [(low, y, x), (low, z, y), (low, x, z), (high, -x, -y), (high, -y, -z), (high, -z, -x)];
    let room = SceneBuilder::default().room(Vec3::splat(wall), high - wall, &white);
    let scene =
        outside.iter().fold(room, |scene, &(corner, u, v)| scene.quad(corner, u, v, white.clone()));
    Bench::new((low, high), resolution, offset, scene).light(&[], Vec3::ONE, 2)
}

/// The walls inside a closed hall have less than 0.9 % of the light outside. They had 1.8 %, more
/// than a dark corner gets from a window, when cones treated gaps in coarse steps and cells as
/// open.
#[test]
fn a_closed_hall_gets_less_than_a_hundredth_of_the_sky() {
    let high = Vec3::new(4.6, 3.3, 5.6);
    for step in 0..4 {
        let offset = Vec3::splat(step as f32 / 4.0);
        let lit = closed_room(high, 0.3, 64, offset);
        let is_inside = |face: &FaceRecord| {
            let at = Vec3::from(face.position_in_world);
            at.cmpgt(Vec3::splat(0.2)).all() && at.cmplt(high - 0.2).all()
        };
        let (inside, outside) = (lit.mean(is_inside), lit.mean(|face| !is_inside(face)));
        println!("offset {}: {inside} inside, {outside} outside", offset.x);
        assert!(inside < 0.009 * outside, "{inside} inside, {outside} outside");
    }
}

/// A closed room with walls a quarter of a metre thick is dark under a bright sky, at its edges
/// too, wherever its walls fall in the grid.
#[test]
fn no_sky_shines_in_at_the_edges_of_a_room() {
    for step in 0..4 {
        let offset = Vec3::splat(step as f32 / 4.0);
        let lit = closed_room(Vec3::splat(1.5), 0.25, 48, offset);
        let is_inside =
            |face: &FaceRecord| face.position_in_world.iter().all(|p| (0.2..1.3).contains(p));
        let outside = lit.mean(|face| !is_inside(face));
        assert!(outside > 0.4, "{outside} outside");
        let near = |face: &FaceRecord, p: f32| {
            face.position_in_world.iter().filter(|x| (*x - p).abs() < 1.0 / 32.0).count()
        };
        // Counts faces near at least two walls.
        let edges = lit.mean(|face| is_inside(face) && near(face, 0.25) + near(face, 1.25) > 1);
        println!("edges at {}: {edges}", offset.x);
        assert!(edges < 0.03, "offset {}: the edges inside have {edges} of {outside}", offset.x);
    }
}

/// A black box with a white floor under a sky, below a cover 0.42 m above the floor; the mean
/// radiance of the floor, lit by the sky and by a lamp outside whose shadow is a cone.
fn light_below(cover: impl FnOnce(SceneBuilder) -> SceneBuilder) -> [f32; 2] {
    let black = lambert(0.0, 0.0);
    let (x, y, z) = (Vec3::X, Vec3::Y * 0.6, Vec3::Z);
    let scene = SceneBuilder::default()
        .quad(Vec3::ZERO, z, x, lambert(0.5, 0.0))
        .quad(Vec3::ZERO, y, z, black.clone())
        .quad(x, z, y, black.clone())
        .quad(Vec3::ZERO, x, y, black.clone())
        .quad(z, y, x, black);
    let scene = cover(scene);
    let bounds = (Vec3::ZERO, Vec3::new(1.0, 0.6, 1.0));
    let mut bench = Bench::new(bounds, 32, Vec3::new(0.3, 0.5, 0.7), scene);
    let lamp = candle(Vec3::new(0.45, 0.9, 0.55), Shadow::Cone);
    let mut floor = |lights: &[Light], sky| {
        let lit = bench.light(lights, Vec3::splat(sky), 2);
        lit.mean(|face| face.position_in_world[1] < 0.1 && face.vector_area[1] > 0.0)
    };
    [floor(&[], 1.0), floor(&[lamp], 0.0)]
}

/// A cover with holes or transmission lets that share of the light through, for cones of any width.
#[test]
#[ignore = "slow: over three seconds"]
fn a_cover_lets_light_through_in_proportion() {
    let cover = |alpha: f32, transmission: f32, double_sided| crate::SurfaceMaterial {
        // Black leaves; white glass, which reflects the rest upwards.
        reflectance: Vec3::splat(transmission).extend(alpha),
        transmission,
        alpha_is_coverage: true,
        double_sided,
        ..crate::SurfaceMaterial::default()
    };
    let open = light_below(|scene| scene);
    for (alpha, transmission, double_sided) in [
        (0.25, 0.0, false),
        (0.5, 0.0, false),
        (0.5, 0.0, true),
        (0.75, 0.0, true),
        (0.2, 0.0, true),
        (1.0, 0.9, false),
    ] {
        let material = cover(alpha, transmission, double_sided);
        let passed = light_below(|scene| scene.quad(Vec3::Y * 0.42, Vec3::X, Vec3::Z, material));
        let expected = alpha * (1.0 - transmission * transmission);
        let [sky, lamp] = [0, 1].map(|i| 1.0 - passed[i] / open[i]);
        println!(
            "alpha {alpha}, transmission {transmission}: of the sky {sky:.4}, of the lamp \
             {lamp:.4} are blocked, of {expected}"
        );
        // A ray passes or not; the lamp's 1000 faces have one each, for a deviation of 0.016.
        assert!((sky - expected).abs() < 0.04, "of the sky's light {sky}, not {expected}");
        assert!((lamp - expected).abs() < 0.04, "of the lamp's light {lamp}, not {expected}");
    }
}

/// Squares of a quarter of a voxel's edge, four in each voxel, block the light of their area: as
/// two-sided sheets, as backs of sheets, and as slabs with a front and a back. The bits of their
/// cover would block a third more.
#[test]
#[ignore = "slow: over three seconds"]
fn a_lattice_finer_than_voxels_blocks_its_area() {
    const STEP: f32 = 1.0 / 64.0;
    let lattice = |scene: SceneBuilder, y: f32, u: Vec3, v: Vec3, double_sided| {
        let material = crate::SurfaceMaterial { double_sided, ..lambert(0.0, 0.0) };
        (0..64 * 64).fold(scene, |scene, i| {
            let corner = Vec3::new((i % 64) as f32 * STEP, y, (i / 64) as f32 * STEP);
            scene.quad(corner, 0.5 * STEP * u, 0.5 * STEP * v, material.clone())
        })
    };
    let open = light_below(|scene| scene);
    let sheets = light_below(|scene| lattice(scene, 0.42, Vec3::X, Vec3::Z, true));
    let backs = light_below(|scene| lattice(scene, 0.42, Vec3::X, Vec3::Z, false));
    let slabs = light_below(|scene| {
        let below = lattice(scene, 0.4199, Vec3::X, Vec3::Z, false);
        lattice(below, 0.4201, Vec3::Z, Vec3::X, false)
    });
    for (name, passed) in [("sheets", sheets), ("backs", backs), ("slabs", slabs)] {
        let [sky, lamp] = [0, 1].map(|i| 1.0 - passed[i] / open[i]);
        println!("{name}: of the sky {sky:.4}, of the lamp {lamp:.4} are blocked, of 0.25");
        assert!((sky - 0.25).abs() < 0.05, "{name} block {sky} of the sky's light, not 0.25");
        assert!((lamp - 0.25).abs() < 0.05, "{name} block {lamp} of the lamp's light, not 0.25");
    }
}

/// Two rooms with a wall thinner than a voxel between them and no doorway: all light in the dark
/// one is a leak. Leaks depend on where the wall falls in the coarser levels, so several grid
/// offsets are tried.
#[test]
fn a_thin_wall_keeps_the_dark_room_dark() {
    let wall = 0.005;
    let bounds = (Vec3::new(-1.0, 0.0, 0.0), Vec3::new(1.0, 1.0, 1.0));
    let white = lambert(0.7, 0.0);
    let mut worst = 0.0_f32;
    for offset in [Vec3::ZERO, Vec3::new(0.5, 0.25, 0.75), Vec3::new(0.25, 0.6, 0.1)] {
        let scene = SceneBuilder::default()
            .room(bounds.0, Vec3::new(-0.5 * wall, 1.0, 1.0), &white)
            .room(Vec3::new(0.5 * wall, 0.0, 0.0), bounds.1, &white);
        let mut bench = Bench::new(bounds, 64, offset, scene);
        let lamp = candle(Vec3::new(-0.5, 0.8, 0.5), Shadow::Cone);
        let lit = bench.light(&[lamp], Vec3::ZERO, 3);
        let lit_room = lit.mean(|face| face.position_in_world[0] < -0.1);
        let dark_room = lit.mean(|face| face.position_in_world[0] > 0.1);
        println!("offset {offset}: leak {:.2} %", 100.0 * dark_room / lit_room);
        worst = worst.max(dark_room / lit_room);
    }
    // 0.5 to 1.0 % were measured (lavapipe).
    assert!(worst < 0.015, "the dark room has {worst} of the lit one's light");
}

/// Walls made of sheets on a ground that continues outside: the ground inside is not lit by the sky
/// outside, whichever side of a voxel the walls are on.
#[test]
fn a_house_on_the_ground_keeps_the_sky_out() {
    let bounds = (Vec3::new(-2.0, -0.1, -2.0), Vec3::new(2.0, 1.1, 2.0));
    let sheet = crate::SurfaceMaterial { double_sided: true, ..lambert(0.7, 0.0) };
    for offset in [Vec3::ZERO, Vec3::new(0.5, 0.25, 0.75), Vec3::new(0.25, 0.6, 0.1)] {
        let (x, y, z) = (Vec3::X * 1.2, Vec3::Y, Vec3::Z * 1.2);
        let corner = Vec3::new(-0.6, 0.0, -0.6);
        let scene = SceneBuilder::default()
            .quad(Vec3::new(-2.0, 0.0, -2.0), Vec3::Z * 4.0, Vec3::X * 4.0, lambert(0.7, 0.0))
            .quad(corner, x, y, sheet.clone())
            .quad(corner + z, x, y, sheet.clone())
            .quad(corner, z, y, sheet.clone())
            .quad(corner + x, z, y, sheet.clone())
            .quad(corner + y, x, z, sheet.clone());
        let mut bench = Bench::new(bounds, 64, offset, scene);
        let lit = bench.light(&[], Vec3::ONE, 3);
        let is_inside = |at: [f32; 3]| at[0].abs().max(at[2].abs()) < 0.55 && at[1] < 0.95;
        let inside = lit.mean(|face| is_inside(face.position_in_world));
        let outside = lit.mean(|face| face.position_in_world[0] > 0.7);
        println!("offset {offset}: {:.3} % inside", 100.0 * inside / outside);
        assert!(inside < 0.001 * outside, "{inside} inside, {outside} outside");
    }
}
