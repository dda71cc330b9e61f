//! Compares irradiance at points with closed forms.

use std::f32::consts::PI;

use glam::Vec3;

use super::{GatherPoints, GatherSettings, GatheredPoint, Irradiance};
use crate::gpu::{Pipelines, Recorder, Timing};
use crate::testing::{SceneBuilder, device, lambert, read};
use crate::{Gi, GiConfig, Grid, Light, LightSource, Lights, Shadow, TraceSettings};

struct Lab {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
    lights: Lights,
}

impl Lab {
    fn new(
        scene: SceneBuilder,
        resolution: u32,
        (lights, environment): (&[Light], Vec3),
        bounces: u32,
    ) -> Self {
        let (device, queue) = device();
        let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, resolution, Vec3::ZERO).expect("it fits");
        let mut gi = Gi::with_pipelines(&device, &queue, GiConfig::new(grid)).expect("a device");
        let geometry = scene.build(&device);
        pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
        let lights = gi.bind_lights(lights, environment, None);
        let mut recorder = Recorder::new(&device, &queue);
        gi.light(&mut recorder, &lights, bounces, &TraceSettings::default()).expect("valid");
        recorder.submit();
        Self { device, queue, gi, lights }
    }

    fn gather(&self, points: &[(Vec3, Vec3)], settings: &GatherSettings) -> Vec<Irradiance> {
        let (positions, normals): (Vec<Vec3>, Vec<Vec3>) = points.iter().copied().unzip();
        pollster::block_on(self.gi.gather(&positions, &normals, &self.lights, settings))
            .expect("the points are good")
    }
}

/// Points all over the box, with normals in all directions.
fn scattered(count: u32) -> Vec<(Vec3, Vec3)> {
    let share = |i: u32, step: f32| (step * i as f32).fract();
    (0..count)
        .map(|i| {
            let place = Vec3::new(share(i, 0.8191), share(i, 0.6711), share(i, 0.5497));
            let normal = Vec3::new(share(i, 0.311), share(i, 0.733), share(i, 0.127)) - 0.5;
            (0.15 + 0.7 * place, normal)
        })
        .collect()
}

/// In a closed box that emits 1 and reflects a half everywhere, the radiance is 2, and the
/// irradiance 2 pi, everywhere.
#[test]
fn points_in_a_furnace_have_the_irradiance_of_its_closed_form() {
    let room = SceneBuilder::default().room(Vec3::ZERO, Vec3::ONE, &lambert(0.5, 1.0));
    let lab = Lab::new(room, 32, (&[], Vec3::ZERO), 10);
    // Gathers draw eight points of the emissive walls a frame; after 16 frames the noise is 14 % at
    // the worst point.
    let settings = GatherSettings { frames: 128, ..GatherSettings::default() };
    let gathered = lab.gather(&scattered(64), &settings);
    let mean = gathered.iter().map(|point| point.indirect.y).sum::<f32>() / 64.0;
    println!("furnace: {} of 2 pi", mean / PI);
    // The bounces at 32 voxels miss up to 4 % (`light/tests.rs`); gathers in the room add no error.
    assert!((1.90..2.03).contains(&(mean / PI)), "{} pi, not 2 pi", mean / PI);
    for point in gathered {
        assert!((point.indirect.y / mean - 1.0).abs() < 0.1, "{point:?} beside a mean of {mean}");
        assert!(point.openness < 0.05, "{point:?}");
        assert_eq!(point.direct, Vec3::ZERO);
    }
}

/// A lamp of 1 cd over a floor: cos / d^2 in the open, zero below a plate, and zero unless direct
/// light is requested.
#[test]
fn direct_light_at_points_follows_the_inverse_square() {
    let plate = SceneBuilder::default().quad(
        Vec3::new(0.6, 0.5, 0.1),
        Vec3::Z * 0.8,
        Vec3::X * 0.3,
        crate::SurfaceMaterial { double_sided: true, ..lambert(0.5, 0.0) },
    );
    let lamp = Vec3::new(0.5, 0.9, 0.5);
    let source =
        LightSource::Point { position: lamp, intensity: Vec3::ONE, radius_m: 0.0, range_m: None };
    let light = Light { source, shadow: Shadow::Cone };
    let lab = Lab::new(plate, 32, (&[light], Vec3::ZERO), 1);
    let points: Vec<(Vec3, Vec3)> =
        (0..8).map(|i| (Vec3::new(0.05 + 0.05 * i as f32, 0.1, 0.5), Vec3::Y * 3.0)).collect();
    let settings = GatherSettings::default();
    for (point, (position, _)) in lab.gather(&points, &settings).iter().zip(&points) {
        let to_lamp = lamp - *position;
        let expected = to_lamp.normalize().y / to_lamp.length_squared();
        let error = point.direct.y / expected - 1.0;
        assert!(error.abs() < 1e-4, "at {position}: {} of {expected}", point.direct.y);
        assert_eq!(point.total(), point.direct + point.indirect);
    }
    let below = [(Vec3::new(0.95, 0.1, 0.5), Vec3::Y)];
    assert!(lab.gather(&below, &settings)[0].direct.y < 0.02);
    let without = GatherSettings { direct: false, ..settings };
    assert_eq!(lab.gather(&points, &without)[0].direct, Vec3::ZERO);
}

/// A wall gets half of the sky's light, its open share.
#[test]
fn sky_light_at_points_follows_their_open_share() {
    let floor = SceneBuilder::default().quad(
        Vec3::ZERO,
        Vec3::Z,
        Vec3::X,
        crate::SurfaceMaterial { double_sided: true, ..lambert(0.0, 0.0) },
    );
    let lab = Lab::new(floor, 32, (&[], Vec3::ONE), 1);
    let middle = Vec3::new(0.5, 0.02, 0.5);
    let settings = GatherSettings { frames: 256, ..GatherSettings::default() };
    let [up, aside] = lab.gather(&[(middle, Vec3::Y), (middle, Vec3::X)], &settings)[..] else {
        unreachable!("there are two points")
    };
    assert!((up.indirect.y / PI - 1.0).abs() < 0.01, "{up:?}");
    assert!((up.openness - 1.0).abs() < 0.01, "{up:?}");
    // The black floor ends at half a metre: it hides a little less than half of the view.
    assert!((0.45..0.58).contains(&(aside.indirect.y / PI)), "{aside:?}");
    assert!((aside.openness - aside.indirect.y / PI).abs() < 0.02, "{aside:?}");
}

/// Gathers of a few frames at a time give the mean of one long gather, and the order of points does
/// not matter.
#[test]
fn split_gathers_and_reordered_points_give_equal_results() {
    let room = SceneBuilder::default().room(Vec3::ZERO, Vec3::ONE, &lambert(0.5, 1.0));
    let lab = Lab::new(room, 16, (&[], Vec3::ZERO), 2);
    let points = scattered(16);
    let whole = GatherSettings { frames: 12, ..GatherSettings::default() };
    let at_once = lab.gather(&points, &whole);
    let mut backwards = points.clone();
    backwards.reverse();
    let mut reversed = lab.gather(&backwards, &whole);
    reversed.reverse();
    assert!(at_once == reversed);

    let (positions, normals): (Vec<Vec3>, Vec<Vec3>) = points.into_iter().unzip();
    let uploaded = GatherPoints::upload(&lab.device, &positions, &normals);
    let part = GatherSettings { frames: 4, ..whole };
    let record = |recorder: &mut Recorder| {
        lab.gi.record_gather(recorder, &uploaded, &lab.lights, &part).expect("valid settings");
    };
    let mut recorder = Recorder::new(&lab.device, &lab.queue);
    // Frames before a restart do not count.
    record(&mut recorder);
    uploaded.restart(&mut recorder);
    (0..3).for_each(|_| record(&mut recorder));
    recorder.submit();
    let gathered: Vec<GatheredPoint> = read(&lab.device, &lab.queue, uploaded.gathered(), 16);
    assert!(gathered.iter().all(|point| point.frames == 12));
    let in_parts: Vec<Irradiance> = gathered.into_iter().map(Irradiance::from).collect();
    assert!(in_parts == at_once);
}

/// Every requested frame is gathered, even if there are many frames or, with many emitters, slow
/// ones.
#[test]
fn every_requested_frame_is_gathered() {
    let rooms = (0..8).fold(SceneBuilder::default(), |scene, index| {
        let edge = 1.0 - 0.1 * index as f32;
        let low = Vec3::splat(0.5 - 0.5 * edge);
        scene.room(low, low + edge, &lambert(0.5, 1.0))
    });
    let lab = Lab::new(rooms, 64, (&[], Vec3::ZERO), 1);
    let (positions, normals): (Vec<Vec3>, Vec<Vec3>) = scattered(8).into_iter().unzip();
    let points = GatherPoints::upload(&lab.device, &positions, &normals);
    let settings = GatherSettings { frames: 300, ..GatherSettings::default() };
    let mut recorder = Recorder::new(&lab.device, &lab.queue);
    lab.gi.record_gather(&mut recorder, &points, &lab.lights, &settings).expect("valid settings");
    recorder.submit();
    let gathered: Vec<GatheredPoint> = read(&lab.device, &lab.queue, points.gathered(), 8);
    assert!(gathered.iter().all(|point| point.frames == 300), "{gathered:?}");
}

#[test]
fn invalid_points_are_refused() {
    let room = SceneBuilder::default().room(Vec3::ZERO, Vec3::ONE, &lambert(0.5, 1.0));
    let lab = Lab::new(room, 16, (&[], Vec3::ZERO), 1);
    let refused = |positions: &[Vec3], normals: &[Vec3], frames| {
        let settings = GatherSettings { frames, ..GatherSettings::default() };
        pollster::block_on(lab.gi.gather(positions, normals, &lab.lights, &settings))
            .expect_err("it must be refused")
            .to_string()
    };
    let middle = Vec3::splat(0.5);
    assert!(refused(&[middle; 2], &[Vec3::Y], 1).contains("2 positions, but 1 normals"));
    assert!(refused(&[middle; 2], &[Vec3::Y, Vec3::ZERO], 1).starts_with("point 1: its normal"));
    assert!(refused(&[Vec3::NAN], &[Vec3::Y], 1).starts_with("point 0: its position"));
    assert!(refused(&[middle], &[Vec3::Y], 0).contains("must be from 1 to 65536"));
    assert!(lab.gather(&[], &GatherSettings::default()).is_empty());
}
