//! Compares light of emitters with closed forms.

use std::f32::consts::PI;

use glam::{Mat4, Vec2, Vec3};

use super::EmitterRecord;
use crate::gpu::{Buffer, Pipelines, Recorder, Timing};
use crate::light::Budget;
use crate::testing::{SceneBuilder, device, lambert, read, wait_until_read};
use crate::{
    Draw, GatherSettings, Geometry, GeometryBatch, Gi, GiConfig, Grid, Lights, SurfaceMaterial,
    SurfaceTexture, TraceSettings, VertexAttributes, VolumeKind,
};

/// A scene in the unit cube, lit by its emissive surfaces.
struct Lab {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
    lights: Lights,
}

impl Lab {
    fn empty(volume: VolumeKind, resolution: u32) -> Self {
        let (device, queue) = device();
        let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, resolution, Vec3::ZERO).expect("it fits");
        let config = GiConfig { volume, ..GiConfig::new(grid) };
        let gi = Gi::with_pipelines(&device, &queue, config).expect("a device");
        let lights = gi.bind_lights(&[], Vec3::ZERO, None);
        Self { device, queue, gi, lights }
    }

    fn new(scene: SceneBuilder, resolution: u32) -> Self {
        let mut lab = Self::empty(VolumeKind::Dense, resolution);
        let geometry = scene.build(&lab.device);
        lab.take(&geometry);
        lab
    }

    /// Voxelizes, and lights without bounces.
    fn take(&mut self, geometry: &Geometry) {
        pollster::block_on(self.gi.voxelize(geometry, Timing::Off)).expect("there are voxels");
        self.light(1);
    }

    fn light(&mut self, bounces: u32) {
        let mut recorder = Recorder::new(&self.device, &self.queue);
        let settings = TraceSettings::default();
        self.gi.light(&mut recorder, &self.lights, bounces, &settings).expect("valid");
        recorder.submit();
    }

    /// Indirect irradiance at points with normals.
    fn gather(&self, points: &[(Vec3, Vec3)], frames: u32) -> Vec<Vec3> {
        let (positions, normals): (Vec<Vec3>, Vec<Vec3>) = points.iter().copied().unzip();
        let settings = GatherSettings { frames, ..GatherSettings::default() };
        let gathered = self.gi.gather(&positions, &normals, &self.lights, &settings);
        let gathered = pollster::block_on(gathered).expect("the points are good");
        gathered.into_iter().map(|point| point.indirect).collect()
    }

    fn emitters(&self) -> Vec<EmitterRecord> {
        let list = self.gi.emitters().list();
        let count = read::<u32>(&self.device, &self.queue, list, 1)[0] as usize;
        let words = read::<u32>(&self.device, &self.queue, list, 4 + 16 * count);
        bytemuck::pod_collect_to_vec(&words[4..])
    }
}

/// Irradiance from a fully visible polygon of radiance 1 (Lambert 1760); corners are
/// counter-clockwise, seen from the point.
fn polygon_irradiance(point: Vec3, normal: Vec3, corners: &[Vec3]) -> f32 {
    let sides = (0..corners.len()).map(|i| {
        let [a, b] =
            [corners[i], corners[(i + 1) % corners.len()]].map(|c| (c - point).normalize());
        a.dot(b).clamp(-1.0, 1.0).acos() * normal.dot(a.cross(b).normalize())
    });
    0.5 * sides.sum::<f32>().abs()
}

fn quad_irradiance(point: Vec3, normal: Vec3, [corner, u, v]: [Vec3; 3]) -> f32 {
    polygon_irradiance(point, normal, &[corner, corner + u, corner + u + v, corner + v])
}

/// A square lamp that faces down from a height.
fn lamp(height: f32) -> [Vec3; 3] {
    [Vec3::new(0.4, height, 0.4), Vec3::X * 0.2, Vec3::Z * 0.2]
}

/// Points on a floor, near the lamp, and on a wall.
fn receivers() -> Vec<(Vec3, Vec3)> {
    let floor = (0..9).map(|i| Vec3::new(0.1 + 0.1 * i as f32, 0.05, 0.33)).map(|p| (p, Vec3::Y));
    let near = (0..5).map(|i| Vec3::new(0.35 + 0.07 * i as f32, 0.75, 0.5)).map(|p| (p, Vec3::Y));
    let wall = (0..6).map(|i| Vec3::new(0.05, 0.1 + 0.1 * i as f32, 0.6)).map(|p| (p, Vec3::X));
    floor.chain(near).chain(wall).collect()
}

/// The mean and the largest relative error of the light at the receivers.
fn errors(gathered: &[Vec3], expected: impl Fn(Vec3, Vec3) -> f32) -> [f32; 2] {
    let errors: Vec<f32> = (gathered.iter().zip(receivers()))
        .map(|(light, (point, normal))| light.y / expected(point, normal) - 1.0)
        .collect();
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    [mean, errors.iter().fold(0.0, |largest, error| largest.max(error.abs()))]
}

/// The lamp's light is complete whether the ceiling behind it is in the same voxel, in the next
/// one, or far away. After 64 frames the drawn points have errors of a few thousandths.
#[test]
fn a_lamp_below_a_ceiling_sends_out_all_its_light() {
    for gap_voxels in [0.05, 0.6, 1.0, 1.7, 3.0] {
        let height = 0.93 - 0.4 / 16.0;
        let ceiling = height + gap_voxels / 16.0;
        let [corner, u, v] = lamp(height);
        let scene = SceneBuilder::default()
            .quad(Vec3::new(0.0, ceiling, 0.0), Vec3::X, Vec3::Z, lambert(0.0, 0.0))
            .quad(corner, u, v, lambert(0.0, 3.0));
        let gathered = Lab::new(scene, 16).gather(&receivers(), 64);
        let [bias, worst] =
            errors(&gathered, |point, normal| 3.0 * quad_irradiance(point, normal, lamp(height)));
        println!("gap {gap_voxels}: bias {bias:+.4}, worst {worst:.4}");
        assert!(bias.abs() < 0.006, "gap {gap_voxels}: bias {bias}");
        assert!(worst < 0.02, "gap {gap_voxels}: worst {worst}");
    }
}

/// A single frame samples the lamp at every point, not by chance.
#[test]
fn one_frame_approximates_the_lamp_at_every_point() {
    let [corner, u, v] = lamp(0.9);
    let scene = SceneBuilder::default().quad(corner, u, v, lambert(0.0, 1.0)).quad(
        Vec3::ZERO,
        Vec3::Z,
        Vec3::X,
        lambert(0.0, 0.0),
    );
    let gathered = Lab::new(scene, 32).gather(&receivers(), 1);
    let [_, worst] = errors(&gathered, |point, normal| quad_irradiance(point, normal, lamp(0.9)));
    println!("one frame: worst {worst:.3}");
    assert!(worst < 0.15, "one frame is off by {worst}");
}

/// Only double-sided surfaces emit from their back.
#[test]
fn only_double_sided_emitters_shine_to_the_back() {
    for double_sided in [false, true] {
        let [corner, u, v] = lamp(0.5);
        let material = SurfaceMaterial { double_sided, ..lambert(0.0, 1.0) };
        let lab = Lab::new(SceneBuilder::default().quad(corner, u, v, material), 32);
        let above = Vec3::new(0.5, 0.9, 0.5);
        let gathered = lab.gather(&[(above, Vec3::NEG_Y), (above, Vec3::Y)], 16);
        let expected = quad_irradiance(above, Vec3::NEG_Y, lamp(0.5)) * f32::from(double_sided);
        assert!((gathered[0].y - expected).abs() <= 0.01 * expected, "{gathered:?}, {expected}");
        assert_eq!(gathered[1], Vec3::ZERO, "nothing comes from behind");
    }
}

/// The six sides of a cuboid of this size below the top of the cube, turned about y against the
/// grid: a corner and two edges each, counter-clockwise from outside; the sides of y are in the
/// middle.
fn cuboid(size: Vec3) -> [[Vec3; 3]; 6] {
    let turn = Mat4::from_rotation_y(0.5);
    let edges = [Vec3::X * size.x, Vec3::Y * size.y, Vec3::Z * size.z];
    let [x, y, z] = edges.map(|edge| turn.transform_vector3(edge));
    let low = Vec3::new(0.5, 0.88, 0.5) - 0.5 * (x + y + z);
    [[low, z, y], [low + x, y, z], [low, x, z], [low + y, z, x], [low, y, x], [low + z, x, y]]
}

/// Thinner than a voxel of 1 / 16.
const BAR: Vec3 = Vec3::new(0.5, 0.015, 0.02);

fn with_sides(
    scene: SceneBuilder,
    sides: &[[Vec3; 3]],
    material: &SurfaceMaterial,
) -> SceneBuilder {
    sides.iter().fold(scene, |scene, &[corner, u, v]| scene.quad(corner, u, v, material.clone()))
}

/// The irradiance from the outer sides of a cuboid of radiance 1.
fn outer_irradiance(sides: &[[Vec3; 3]], point: Vec3, normal: Vec3) -> f32 {
    let seen = sides.iter().filter(|[corner, u, v]| u.cross(*v).dot(point - *corner) > 0.0);
    seen.map(|&side| quad_irradiance(point, normal, side)).sum()
}

/// All sides of a thin lamp are visible from outside, and its inside is not, whether its material
/// is one- or double-sided, and whichever way its triangles wind.
#[test]
fn a_thin_lamp_is_bright_on_all_its_outer_sides_only() {
    for (double_sided, is_inside_out) in [(false, false), (true, false), (true, true)] {
        let material = SurfaceMaterial { double_sided, ..lambert(0.0, 1.0) };
        let turned = |[corner, u, v]: [Vec3; 3]| {
            if is_inside_out { [corner, v, u] } else { [corner, u, v] }
        };
        let scene = with_sides(SceneBuilder::default(), &cuboid(BAR).map(turned), &material);
        let gathered = Lab::new(scene, 16).gather(&receivers(), 64);
        let [bias, worst] =
            errors(&gathered, |point, normal| outer_irradiance(&cuboid(BAR), point, normal));
        println!("double-sided {double_sided}, inside out {is_inside_out}: {bias:+.4}, {worst:.4}");
        assert!(bias.abs() < 0.01, "double-sided {double_sided}: bias {bias}");
        assert!(worst < 0.03, "double-sided {double_sided}: worst {worst}");
    }
}

/// The inner sides of an open ring are visible through its lower end.
#[test]
fn an_open_ring_is_bright_inside() {
    let [a, b, .., c, d] = cuboid(Vec3::new(0.05, 0.04, 0.05));
    let material = SurfaceMaterial { double_sided: true, ..lambert(0.0, 1.0) };
    let lab = Lab::new(with_sides(SceneBuilder::default(), &[a, b, c, d], &material), 16);
    let below = Vec3::new(0.5, 0.2, 0.5);
    let light = lab.gather(&[(below, Vec3::Y)], 64)[0].y;
    let expected: f32 =
        [a, b, c, d].iter().map(|&side| quad_irradiance(below, Vec3::Y, side)).sum();
    assert!((light / expected - 1.0).abs() < 0.1, "{light} instead of {expected}");
}

/// A closed room of twelve voxels is not a thin lamp: its double-sided walls emit inwards.
#[test]
fn a_glowing_room_is_bright_inside() {
    let material = SurfaceMaterial { double_sided: true, ..lambert(0.0, 1.0) };
    let walls = cuboid(Vec3::new(0.7, 0.2, 0.7));
    let lab = Lab::new(with_sides(SceneBuilder::default(), &walls, &material), 16);
    let light = lab.gather(&[(Vec3::new(0.5, 0.88, 0.5), Vec3::Y)], 64)[0].y;
    assert!((light / PI - 1.0).abs() < 0.05, "{light} instead of {PI}");
}

/// A closed cover of a hundredth of the lamp's radiance, in the same voxels, hides nearly all of
/// the lamp: 1.6 % of its light passes at the worst place, since faces in a voxel are planes.
#[test]
fn a_dim_cover_hides_the_lamp_in_it() {
    let cover = cuboid(BAR + Vec3::splat(0.04));
    let scene = with_sides(SceneBuilder::default(), &cuboid(BAR), &lambert(0.0, 100.0));
    let lab = Lab::new(with_sides(scene, &cover, &lambert(0.0, 1.0)), 16);
    let gathered = lab.gather(&receivers(), 64);
    let [bias, worst] = errors(&gathered, |point, normal| outer_irradiance(&cover, point, normal));
    println!("a cover of a hundredth of the lamp's radiance: {bias:+.4}, {worst:.4}");
    assert!(bias.abs() < 0.3 && worst < 3.0, "bias {bias}, worst {worst}");
}

/// Points below a plate are in its shadow; the one at its edge sees a part of the lamp.
#[test]
fn a_plate_casts_a_shadow_below_a_lamp() {
    let [corner, u, v] = lamp(0.9);
    let double_sided = SurfaceMaterial { double_sided: true, ..lambert(0.0, 0.0) };
    let scene = SceneBuilder::default().quad(corner, u, v, lambert(0.0, 1.0)).quad(
        Vec3::new(0.0, 0.5, 0.0),
        Vec3::Z,
        Vec3::X * 0.5,
        double_sided,
    );
    let lab = Lab::new(scene, 64);
    let points = [0.1, 0.25, 0.5, 0.8].map(|x| Vec3::new(x, 0.1, 0.5));
    let gathered = lab.gather(&points.map(|point| (point, Vec3::Y)), 256);
    let whole = points.map(|point| quad_irradiance(point, Vec3::Y, lamp(0.9)));
    // The point below the plate's edge sees the half of the lamp beyond it.
    let [corner, u, v] = lamp(0.9);
    let half = quad_irradiance(points[2], Vec3::Y, [corner + 0.5 * u, 0.5 * u, v]);
    assert!(gathered[0].y < 0.01 * whole[0], "{gathered:?}");
    assert!(gathered[1].y < 0.01 * whole[1], "{gathered:?}");
    // The plate's edge is only known to a fraction of a voxel.
    assert!((gathered[2].y / half - 1.0).abs() < 0.12, "{} of {half}", gathered[2].y);
    assert!((gathered[3].y / whole[3] - 1.0).abs() < 0.01, "{} of {}", gathered[3].y, whole[3]);
}

/// Ten thousand emitters of different powers light like one sheet of their sum.
#[test]
fn ten_thousand_emitters_add_up() {
    let edge = 71;
    let [corner, u, v] = lamp(0.9);
    let (u, v) = (u / edge as f32, v / edge as f32);
    let mut scene = SceneBuilder::default();
    let radiance = |i: u32| Vec3::new((i % 3) as f32, (i / 3 % 4) as f32, (i % 5) as f32);
    for i in 0..edge * edge {
        let corner = corner + (i % edge) as f32 * u + (i / edge) as f32 * v;
        let material = SurfaceMaterial { emission: radiance(i), ..lambert(0.0, 0.0) };
        scene = scene.quad(corner, u, v, material);
    }
    let lab = Lab::new(scene, 32);
    let dark = (0..edge * edge).filter(|i| radiance(*i) == Vec3::ZERO).count() as u32;
    assert_eq!(lab.emitters().len() as u32, 2 * (edge * edge - dark));
    let mean = (0..edge * edge).map(radiance).sum::<Vec3>() / (edge * edge) as f32;
    let gathered = lab.gather(&receivers(), 256);
    let sum = gathered.iter().sum::<Vec3>() / gathered.len() as f32;
    let expected = receivers()
        .iter()
        .map(|(point, normal)| mean * quad_irradiance(*point, *normal, lamp(0.9)))
        .sum::<Vec3>()
        / gathered.len() as f32;
    println!("ten thousand emitters: {sum} of {expected}");
    // One of eight draws is kept, with its colour, so colours have more noise than their sum.
    let ratio = sum / expected;
    assert!(
        (sum.element_sum() / expected.element_sum() - 1.0).abs() < 0.015,
        "{sum} of {expected}"
    );
    assert!((ratio - Vec3::ONE).abs().max_element() < 0.06, "{sum} of {expected}");
}

/// Noise at places a few centimetres from a ceiling of five thousand tiny lamps in random order. A
/// choice only by power would seldom find the nearest lamps, for an error of 12 %; here it is 2.5
/// %.
#[test]
fn near_emitters_are_sampled_among_thousands() {
    const SIZE: f32 = 0.002;
    let spread = |i: u32, step: f32| 0.05 + 0.9 * (i as f32 * step).fract();
    let corners: Vec<Vec3> = (0..5000_u32)
        .map(|i| Vec3::new(spread(i, 0.754_877_7), 0.9, spread(i, 0.569_840_3)))
        .collect();
    let mut scene = SceneBuilder::default();
    for corner in &corners {
        scene = scene.quad(*corner, Vec3::X * SIZE, Vec3::Z * SIZE, lambert(0.0, 1.0));
    }
    let lab = Lab::new(scene, 32);
    let points: Vec<(Vec3, Vec3)> = (0..64)
        .map(|i| (Vec3::new(0.02, 0.8 + 0.001 * i as f32, 0.1 + 0.0125 * i as f32), Vec3::X))
        .collect();
    let gathered = lab.gather(&points, 32);
    let expected = points.iter().map(|(point, normal)| {
        let lamp_irradiance = |corner: &Vec3| {
            let to_lamp = *corner + Vec3::new(0.5 * SIZE, 0.0, 0.5 * SIZE) - *point;
            let distance = to_lamp.length();
            SIZE * SIZE * to_lamp.dot(*normal).max(0.0) * to_lamp.y / distance.powi(4)
        };
        corners.iter().map(lamp_irradiance).sum::<f32>()
    });
    let errors: Vec<f32> =
        gathered.iter().zip(expected).map(|(light, expected)| light.y / expected - 1.0).collect();
    let mean = errors.iter().sum::<f32>() / errors.len() as f32;
    let rmse = (errors.iter().map(|e| e * e).sum::<f32>() / errors.len() as f32).sqrt();
    println!("many lamps: bias {mean:+.4}, RMSE {rmse:.4}");
    assert!(mean.abs() < 0.02, "bias {mean}");
    assert!(rmse < 0.05, "RMSE {rmse}");
}

/// A lamp with a texture that is red on one half and dark on the other.
fn half_red(device: &Pipelines, queue: &wgpu::Queue) -> (Geometry, [Buffer; 3]) {
    let size = wgpu::Extent3d { width: 64, height: 64, depth_or_array_layers: 1 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("half red"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let texels: Vec<u8> =
        (0..64 * 64).flat_map(|i| [if i % 64 < 32 { 255 } else { 0 }, 0, 0, 255]).collect();
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(4 * 64),
        rows_per_image: Some(64),
    };
    queue.write_texture(texture.as_image_copy(), &texels, layout, size);
    let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor::default());
    let [corner, u, v] = lamp(0.9);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(Vec2::from);
    let positions = corners.map(|at| (corner + at.x * u + at.y * v).to_array());
    let positions = crate::gpu::upload(device, "positions", &positions);
    let texcoords = crate::gpu::upload(device, "texcoords", &corners.map(|at| at.to_array()));
    let indices = crate::gpu::upload(device, "indices", &[0_u32, 1, 2, 0, 2, 3]);
    let draws = vec![Draw::new(0, 6, 0)];
    let mut batch = GeometryBatch::new((*positions).clone(), (*indices).clone(), draws);
    batch.attributes = Some(VertexAttributes::texcoords((*texcoords).clone()));
    let emission_texture = Some(SurfaceTexture::new(view, sampler));
    let material = SurfaceMaterial { emission_texture, ..lambert(0.0, 2.0) };
    let geometry = Geometry::new(vec![batch], vec![material]);
    (geometry, [positions, texcoords, indices])
}

/// A textured surface emits only where its texture is bright.
#[test]
fn textures_shine_where_they_are_bright() {
    let mut lab = Lab::empty(VolumeKind::Dense, 32);
    let (geometry, _buffers) = half_red(&lab.device, &lab.queue);
    lab.take(&geometry);
    let [corner, u, v] = lamp(0.9);
    let gathered = lab.gather(&receivers(), 64);
    let [bias, worst] = errors(
        &gathered.iter().map(|light| Vec3::Y * light.x).collect::<Vec<_>>(),
        |point, normal| 2.0 * quad_irradiance(point, normal, [corner, 0.5 * u, v]),
    );
    println!("half a lamp: bias {bias:+.4}, worst {worst:.4}");
    // Pieces at the edge of the bright half are as bright as their middle.
    assert!(bias.abs() < 0.01 && worst < 0.05, "bias {bias}, worst {worst}");
    assert!(gathered.iter().all(|light| light.y == 0.0 && light.z == 0.0), "{gathered:?}");
}

/// Pieces of a triangle cover it once, with its orientation.
#[test]
fn emitter_pieces_cover_the_triangle_once() {
    let mut lab = Lab::empty(VolumeKind::Dense, 32);
    let (geometry, _buffers) = half_red(&lab.device, &lab.queue);
    lab.take(&geometry);
    let pieces = lab.emitters();
    assert_eq!(pieces.len(), 2 * 32 * 32);
    let [_, u, v] = lamp(0.9).map(|vector| vector / lab.gi.grid().voxel_size_m);
    let (whole, mut area) = (u.cross(v), Vec3::ZERO);
    let mut middles = std::collections::BTreeSet::new();
    for piece in &pieces {
        let [corner, ab, ac] = [piece.corner, piece.along_ab, piece.along_ac].map(Vec3::from_array);
        area += 0.5 * ab.cross(ac);
        let middle = (corner + (ab + ac) / 3.0) * 1000.0;
        middles.insert(middle.round().as_ivec3().to_array());
    }
    assert!((area / whole.length() - whole.normalize()).length() < 1e-4, "{area} of {whole}");
    assert_eq!(middles.len(), pieces.len(), "pieces lie on each other");
}

/// A closed room of emitters, with corners, where solid angles are large.
#[test]
fn glowing_walls_light_each_other() {
    let room = SceneBuilder::default().room(Vec3::ZERO, Vec3::ONE, &lambert(0.0, 1.0));
    let lab = Lab::new(room, 32);
    let points: Vec<(Vec3, Vec3)> = (0..100)
        .map(|i| {
            (Vec3::new(0.05 + 0.1 * (i % 10) as f32, 0.0, 0.05 + 0.1 * (i / 10) as f32), Vec3::Y)
        })
        .collect();
    let gathered = lab.gather(&points, 64);
    let mean = gathered.iter().map(|light| light.y).sum::<f32>() / (100.0 * PI);
    let worst = gathered.iter().map(|light| (light.y / PI - 1.0).abs()).fold(0.0, f32::max);
    println!("shining walls: {mean:.4} of pi, worst {worst:.4}");
    // Rays that end on a wall close to a corner graze the other wall's voxels.
    assert!((0.96..1.01).contains(&mean), "{mean} of pi");
    assert!(worst < 0.15, "worst {worst}");
}

/// Two runs have the same bits, with dense volumes and octrees. So has a lamp that has moved to its
/// place from elsewhere, except for last bits in octrees, since places of bricks differ.
#[test]
#[ignore = "slow: over three seconds"]
fn a_lamps_light_does_not_depend_on_its_past() {
    for volume in [VolumeKind::Dense, VolumeKind::Octree] {
        let scene = || {
            let [corner, u, v] = lamp(0.5);
            let material =
                SurfaceMaterial { emission: Vec3::new(3.0, 2.0, 1.0), ..lambert(0.4, 0.0) };
            SceneBuilder::default()
                .room(Vec3::ZERO, Vec3::ONE, &lambert(0.6, 0.01))
                .fixed()
                .quad(corner, u, v, material)
        };
        let mut lab = Lab::empty(volume, 16);
        let mut geometry = scene().build(&lab.device);
        let lift = |geometry: &mut Geometry, by: f32| {
            if let Some(draw) = geometry.batches[0].draws.last_mut() {
                draw.world_from_local = Mat4::from_translation(by * Vec3::Y);
            }
        };
        let light = |lab: &mut Lab, geometry: &Geometry| {
            lab.take(geometry);
            lab.light(3);
            lab.gather(&receivers(), 4)
        };
        lift(&mut geometry, 0.3);
        let fresh = light(&mut Lab::empty(volume, 16), &geometry);
        assert_eq!(fresh, light(&mut lab, &geometry), "{volume:?}: another run");
        assert_eq!(fresh, lab.gather(&receivers(), 4), "{volume:?}: the volume stays as it was");
        // Moves the lamp away and back, in frames.
        for height in [0.1, 0.2, 0.3, 0.3, 0.3, 0.3, 0.3] {
            lift(&mut geometry, height);
            let mut recorder = Recorder::new(&lab.device, &lab.queue);
            lab.gi.voxelize_frame(&mut recorder, &geometry).expect("there is room");
            let settings = TraceSettings::default();
            lab.gi.light_step(&mut recorder, &lab.lights, Budget::Faces(None), &settings);
            recorder.submit();
            wait_until_read(&lab.device, &lab.gi);
        }
        lab.light(3);
        let moved = lab.gather(&receivers(), 4);
        let most = if volume == VolumeKind::Dense { 0.0 } else { 1e-5 };
        for (fresh, moved) in fresh.iter().zip(moved) {
            assert!(fresh.distance(moved) <= most * fresh.length(), "{volume:?}: {fresh}, {moved}");
        }
    }
}

/// After the emission is removed, it is dark.
#[test]
fn no_light_remains_after_emission_is_removed() {
    let [corner, u, v] = lamp(0.9);
    let mut lab = Lab::empty(VolumeKind::Dense, 16);
    let scene = SceneBuilder::default().quad(corner, u, v, lambert(0.5, 1.0));
    let mut geometry = scene.build(&lab.device);
    lab.take(&geometry);
    assert!(lab.gather(&receivers(), 4).iter().all(|light| light.y > 0.0));
    geometry.materials[0].emission = Vec3::ZERO;
    lab.take(&geometry);
    assert!(lab.gather(&receivers(), 4).iter().all(|light| *light == Vec3::ZERO));
}
