//! Compares shaders' samples of maps, and irradiance from cones, with integrals over the panorama.

use half::f16;

use super::*;
use crate::environment::{CubeUse, EnvironmentCube, EnvironmentLight, EnvironmentMap};
use crate::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Pipelines, Recorder, Timing, storage_buffer, upload,
};
use crate::testing::{SceneBuilder, device, lambert, read};
use crate::voxels::FaceRecord;
use crate::{Gi, GiConfig, Grid, Preset, TraceSettings};
use glam::Vec4;

/// A single tile with a normal, whose faces are lit by a map.
struct Tile {
    device: Pipelines,
    queue: wgpu::Queue,
    gi: Gi,
}

impl Tile {
    fn new(normal: Vec3) -> Self {
        let (device, queue) = device();
        let u = normal.any_orthonormal_vector();
        let v = normal.cross(u);
        let scene = SceneBuilder::default().quad(-0.5 * (u + v), u, v, lambert(1.0, 0.0));
        let reach = 0.5 * (u.abs() + v.abs()) + 0.05;
        let grid = Grid::fit(-reach, reach, 64, Vec3::ZERO).expect("the grid fits");
        let config = GiConfig::new(grid);
        let mut gi =
            Gi::with_pipelines(&device, &queue, config).expect("the device is large enough");
        let geometry = scene.build(&device);
        pollster::block_on(gi.voxelize(&geometry, Timing::Off)).expect("there are voxels");
        Self { device, queue, gi }
    }

    /// The results of a shader function, `fn answer(question: vec4f, index: u32) -> vec3f`, in the
    /// light of a map.
    fn ask(&self, map: &EnvironmentMap, answer: &str, questions: &[Vec4]) -> Vec<Vec3> {
        let mut shaders = self.gi.shaders().clone();
        shaders.add("test::ask", format!("{answer}{ASK_WGSL}"));
        let layout =
            LayoutBuilder::compute().storage().storage_mut().build(&self.device, "questions");
        let layouts = [self.gi.globals_layout(), &layout, self.gi.lights_layout()];
        let kernel =
            Kernel::new(&self.device, &shaders, "test::ask", "main", &layouts).expect("it links");
        let input = upload(&self.device, "questions", questions);
        let output = storage_buffer(&self.device, "answers", questions.len() as u64 * 16);
        let group = BindGroupBuilder::new(&layout).buffer(&input).buffer(&output);
        let group = group.build(&self.device, "questions");
        let environment =
            EnvironmentLight { radiance: Vec3::ONE, map: Some(map), rotation_rad: 0.0 };
        let lights = self.gi.bind_lights(&[], environment, None);
        let mut recorder = Recorder::new(&self.device, &self.queue);
        let groups = [self.gi.globals(), &group, &lights.group];
        kernel.run_linear(&mut recorder, &groups, questions.len() as u64);
        recorder.submit();
        let answers: Vec<Vec4> = read(&self.device, &self.queue, &output, questions.len());
        answers.into_iter().map(Vec4::truncate).collect()
    }

    fn irradiance(
        &mut self,
        map: &EnvironmentMap,
        rotation_rad: f32,
        settings: &TraceSettings,
    ) -> Vec3 {
        let radiance = Vec3::ONE;
        let mut lights = map.lights(radiance, rotation_rad);
        for light in &mut lights {
            light.shadow = crate::Shadow::None;
        }
        let environment = EnvironmentLight { radiance, map: Some(map), rotation_rad };
        let lights = self.gi.bind_lights(&lights, environment, None);
        let mut recorder = Recorder::new(&self.device, &self.queue);
        self.gi.light(&mut recorder, &lights, 2, settings).expect("valid settings");
        recorder.submit();
        let voxels = self.gi.voxels().expect("there are voxels");
        let count = voxels.face_count as usize;
        let faces: Vec<FaceRecord> = read(&self.device, &self.queue, &voxels.faces, count);
        let buffer = self.gi.face_radiance().expect("there is light");
        let radiance: Vec<[f32; 4]> = read(&self.device, &self.queue, buffer, count);
        let mut sum = (Vec3::ZERO, 0.0);
        for (face, radiance) in faces.iter().zip(radiance) {
            // Reflectance is clamped just below one.
            let reflectance = Vec3::from(face.reflectance);
            let area = Vec3::from(face.vector_area).length();
            let rgb = Vec3::new(radiance[0], radiance[1], radiance[2]);
            sum.0 += area * rgb / reflectance * PI as f32;
            sum.1 += area;
        }
        sum.0 / sum.1
    }
}

const ASK_WGSL: &str = "
@group(1) @binding(0) var<storage, read> questions: array<vec4f>;
@group(1) @binding(1) var<storage, read_write> answers: array<vec4f>;
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= arrayLength(&answers) { return; }
    answers[id.x] = vec4f(answer(questions[id.x], id.x), 0.0);
}";

const RADIANCE_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::environment::environment_radiance;
fn answer(question: vec4f, index: u32) -> vec3f {
    return environment_radiance(normalize(question.xyz), question.w);
}";

/// Samples are equally wide everywhere on the cube: they blur a step from black to white equally in
/// the middle of a face and at an edge, where a texel has 0.35 of the solid angle.
#[test]
fn map_samples_blur_equally_across_the_cube() {
    let tile = Tile::new(Vec3::Y);
    let step = image(512, |d| if d.y > 0.0 { Vec3::ONE } else { Vec3::ZERO });
    let map = EnvironmentMap::new(&tile.device, &tile.queue, step.panorama()).expect("a map");
    for width in [0.1, 0.2, 0.3] {
        // The white seen below the step, integrated over the angle.
        let blur = |place: Vec3| -> f32 {
            let angles = (1..200).map(|i| i as f32 / 200.0);
            let ways: Vec<Vec4> = angles
                .map(|angle| {
                    (place.normalize() * angle.cos() - Vec3::Y * angle.sin()).extend(width)
                })
                .collect();
            tile.ask(&map, RADIANCE_WGSL, &ways).iter().map(|seen| seen.x).sum::<f32>() / 200.0
        };
        let (middle, edge) = (blur(Vec3::Z), blur(Vec3::new(1.0, 0.0, 1.0)));
        println!("width {width}: blurred over {middle} in a face's middle, {edge} at its edge");
        // A texel at the edge is 1.19 times as high as wide, and levels are powers of two.
        assert!((0.85..1.45).contains(&(edge / middle)), "width {width}: {middle} and {edge}");
    }
}

/// A cube texture of half floats, like an engine's.
fn cube_texture(device: &wgpu::Device, queue: &wgpu::Queue, cube: &Cube) -> wgpu::TextureView {
    let size = wgpu::Extent3d { width: cube.edge, height: cube.edge, depth_or_array_layers: 6 };
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("sky of an engine"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba16Float,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let halves: Vec<[f16; 4]> =
        cube.texels.iter().map(|texel| texel.extend(1.0).to_array().map(f16::from_f32)).collect();
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(8 * cube.edge),
        rows_per_image: Some(cube.edge),
    };
    queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&halves), layout, size);
    texture.create_view(&wgpu::TextureViewDescriptor {
        dimension: Some(wgpu::TextureViewDimension::Cube),
        ..Default::default()
    })
}

/// A cube texture, finer or coarser than the map, gives the light of its panorama at every width,
/// also with a factor, a rotation, and added constant light.
#[test]
fn a_cube_texture_gives_the_light_of_its_panorama() {
    let tile = Tile::new(Vec3::Y);
    let image = image(256, |d| {
        let lamp = 3.0 * (20.0 * (d.dot(DVec3::new(0.6, 0.48, 0.64)) - 1.0)).exp();
        gradient(d) + Vec3::splat(lamp as f32)
    });
    let shaders = tile.gi.shaders();
    let truth = EnvironmentMap::new(&tile.device, &tile.queue, image.panorama()).expect("a map");
    let questions: Vec<Vec4> = (0..400)
        .map(|i| {
            let (y, turn) = ((i as f32 + 0.5) / 200.0 - 1.0, 2.4 * i as f32);
            let level = (1.0 - y * y).sqrt();
            let width = [0.03, 0.1, 0.3, 0.6][i % 4];
            Vec4::new(level * turn.cos(), y, level * turn.sin(), width)
        })
        .collect();
    for edge in [128, 32] {
        let view = cube_texture(&tile.device, &tile.queue, &Cube::project(image.panorama(), edge));
        let mut cube = EnvironmentCube::new(&tile.device, shaders, 64).expect("a good edge");
        let turn = Mat3::from_rotation_x(0.8) * Mat3::from_rotation_y(-0.5);
        let added = Vec3::new(0.2, 0.1, 0.0);
        for settings in [CubeUse::default(), CubeUse { cube_from_world: turn, factor: 2.0, added }]
        {
            let mut recorder = Recorder::new(&tile.device, &tile.queue);
            cube.record(&mut recorder, &view, settings);
            recorder.submit();
            let found = tile.ask(cube.map(), RADIANCE_WGSL, &questions);
            let turned: Vec<Vec4> = questions
                .iter()
                .map(|q| (settings.cube_from_world * q.truncate()).extend(q.w))
                .collect();
            let expected = tile.ask(&truth, RADIANCE_WGSL, &turned);
            let mut squares = 0.0;
            for ((found, expected), question) in found.iter().zip(&expected).zip(&questions) {
                let expected = *expected * settings.factor + settings.added;
                let error = (*found - expected).abs().max_element() / expected.max_element();
                // A turned map has its coarse texels in other places.
                assert!(error < 0.15, "{edge} {question}: {found}, not {expected}");
                squares += error * error;
            }
            let rms = (squares / questions.len() as f32).sqrt();
            println!("{edge}: {rms}");
            assert!(rms < 0.03, "{edge}: {rms}");
        }
    }
    let refused = EnvironmentCube::new(&tile.device, shaders, 100);
    assert!(refused.is_err_and(|error| error.to_string().contains("power of two")));
}

const GATHER_WGSL: &str = "
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::random::random_pair;
import package::cones::cone::ConeSettings;
import package::cones::gather::gather;
fn answer(question: vec4f, index: u32) -> vec3f {
    var settings = ConeSettings();
    settings.voxel_per_diameter = 0.125;
    settings.clearance = 0.3333;
    settings.normal_offset = 0.5;
    settings.step_per_voxel = 1.0;
    settings.min_transmittance = 0.03;
    settings.occlusion_distance = 3e38;
    let start = random_pair(index, 7u);
    return gather(vec3f(0.0), question.xyz, vec3f(0.0, 1.0, 0.0), 0u, 12u, start, index, settings).irradiance;
}";

/// With a normal map, directions below the surface are mirrored up: in a map of radiance 1 + y, a
/// direction d then finds 1 + |d.y|.
#[test]
fn directions_below_the_surface_are_mirrored_up() {
    let tile = Tile::new(Vec3::Y);
    let map = image(128, |d| Vec3::splat(1.0 + d.y as f32));
    let map = EnvironmentMap::new(&tile.device, &tile.queue, map.panorama()).expect("a map");
    for normal in [Vec3::Y, Vec3::new(0.8, 0.6, 0.0), Vec3::new(0.1, 0.2, -0.97).normalize()] {
        let found = tile.ask(&map, GATHER_WGSL, &vec![normal.extend(0.0); 2000]);
        let mean = found.iter().map(|irradiance| irradiance.x).sum::<f32>() / 2000.0;
        // Malley's method: uniform on the disc is cosine-weighted on the hemisphere.
        let (u, v) = normal.any_orthonormal_pair();
        let folded = (0..40_000).map(|i| {
            let (radius, turn) = (((i / 200) as f32 + 0.5) / 200.0, (i % 200) as f32 / 200.0);
            let (sine, cosine) = (turn * TAU as f32).sin_cos();
            let across = (u * cosine + v * sine) * radius.sqrt();
            (across + normal * (1.0 - radius).sqrt()).y.abs()
        });
        let expected = PI as f32 * (1.0 + folded.sum::<f32>() / 40_000.0);
        println!("{normal}: {mean} of {expected}");
        // llvmpipe: 0.2 %.
        assert!((mean / expected - 1.0).abs() < 0.01, "{normal}: {mean}, not {expected}");
    }
}

/// The cones of a hemisphere add up to the irradiance: compares the mean over the jitter of about
/// 4000 faces with the sum over the panorama, for smooth and for harsh maps.
#[test]
#[ignore = "slow: over three seconds"]
fn cones_sum_up_to_the_irradiance() {
    let half =
        |d: DVec3| if d.x + 0.4 * d.y > 0.1 { Vec3::new(9.0, 6.0, 3.0) } else { Vec3::splat(0.3) };
    let below = |d: DVec3| if d.y < 0.0 { Vec3::splat(5.0) } else { Vec3::splat(1.0) };
    let sun = with_disc(Vec3::new(0.4, 0.8, 0.3), 0.04, 12.0, gradient);
    let lamp = with_disc(Vec3::new(0.3, 0.6, -0.5), 0.35, 12.0, gradient);
    // Tolerances are a little above lavapipe's errors: 0.9, 1.9, 1, 0.5 and 4.5 %. A cone's width
    // blurs the lamp against the cosine; the finest preset errs by less than 1.5 %.
    let maps = [
        ("gradient", image(128, gradient), 0.01),
        ("half", image(128, half), 0.025),
        ("bright below", image(128, below), 0.015),
        ("sun", image(256, sun), 0.01),
        ("lamp", image(128, lamp), 0.05),
    ];
    let presets = [(Preset::Fast, 6), (Preset::Balanced, 9), (Preset::High, 12)];
    let normals = [Vec3::Y, Vec3::NEG_Y, Vec3::X, Vec3::NEG_Z, Vec3::new(0.48, 0.6, 0.64)];
    let (device, queue) = device();
    let maps = maps.map(|(name, image, tolerance)| {
        let map = EnvironmentMap::new(&device, &queue, image.panorama()).expect("a map");
        assert_eq!(map.peaks().len(), usize::from(name == "sun"), "{name}");
        (name, image, map, tolerance)
    });
    let rotation_rad = 0.7;
    for normal in normals {
        let mut tile = Tile::new(normal);
        for (name, image, map, tolerance) in &maps {
            // In the map's frame the normal turns the other way.
            let turned = Mat3::from_rotation_y(-rotation_rad) * normal;
            let expected = irradiance(image.panorama(), turned);
            for (preset, diffuse_cones) in presets {
                let settings = TraceSettings { diffuse_cones, ..TraceSettings::preset(preset) };
                let found = tile.irradiance(map, rotation_rad, &settings);
                let what = format!("{name}, {normal}, {preset:?}, {diffuse_cones} cones");
                close(found, expected, *tolerance, &what);
            }
        }
    }
}

#[test]
fn impossible_panoramas_are_refused() {
    let mut tile = Tile::new(Vec3::Y);
    for (width, height) in [(0, 0), (2, 2), (u32::MAX, u32::MAX)] {
        let panorama = Panorama { width, height, rgb: &[[1.0; 3]; 3] };
        let error =
            EnvironmentMap::new(&tile.device, &tile.queue, panorama).expect_err("too few texels");
        assert!(error.to_string().contains("3 texels for"), "{error}");
    }
    // The smallest panorama is a constant.
    let panorama = Panorama { width: 1, height: 1, rgb: &[[3.0; 3]] };
    let map = EnvironmentMap::new(&tile.device, &tile.queue, panorama).expect("a map");
    assert!(map.peaks().is_empty());
    let found = tile.irradiance(&map, 0.0, &TraceSettings::default());
    close(found, Vec3::splat(3.0 * PI as f32), 1e-3, "a constant");
}
