//! CPU time of a frame in a large scene in which one object moves: 10 000 objects, 2 000 000
//! triangles.
//!
//! `cargo bench -p lumivox-explorer` prints the time of this thread only, ms a frame: a software
//! GPU computes on its own threads. `still` is a frame in which nothing has moved, `moving` one
//! after a move; the lines below are the steps of `moving`.

use std::time::Duration;

use glam::{Mat4, UVec2, Vec3};
use lumivox_explorer::{Explorer, PreparedScene};
use lumivox_render::{Gpu, GpuOptions, PresetChoice, RenderSettings};
use lumivox_scene::{
    Camera, Instance, Light, LightKind, Material, Mesh, Scene, SightOptions, Staging,
};

/// Objects along each edge of the square that they form.
const EDGE: usize = 100;
/// Different meshes with equally many triangles.
const MESHES: usize = 20;
/// Frames per median.
const FRAMES: usize = 21;

/// A ball of 200 triangles.
fn ball(radius_m: f32) -> Mesh {
    const RINGS: u32 = 11;
    const SLICES: u32 = 10;
    let (mut positions, mut indices) = (Vec::new(), Vec::new());
    for ring in 0..=RINGS {
        let (sin, cos) = (std::f32::consts::PI * ring as f32 / RINGS as f32).sin_cos();
        for slice in 0..=SLICES {
            let (y, x) = (std::f32::consts::TAU * slice as f32 / SLICES as f32).sin_cos();
            positions.push(radius_m * Vec3::new(sin * x, cos, sin * y));
        }
    }
    for (ring, slice) in (0..RINGS).flat_map(|ring| (0..SLICES).map(move |slice| (ring, slice))) {
        let at = |ring: u32, slice: u32| ring * (SLICES + 1) + slice;
        let (a, b) = (at(ring, slice), at(ring + 1, slice));
        if ring > 0 {
            indices.extend([a, b, a + 1]);
        }
        if ring + 1 < RINGS {
            indices.extend([a + 1, b, b + 1]);
        }
    }
    let normals = positions.iter().map(|p| p.normalize()).collect();
    let uvs = vec![glam::Vec2::ZERO; positions.len()];
    Mesh { positions, normals, uvs, indices, ..Mesh::default() }
}

fn scene() -> Scene {
    let mut scene = Scene { name: "balls".to_owned(), ..Scene::default() };
    for mesh in 0..MESHES {
        scene.meshes.push(ball(0.3 + 0.005 * mesh as f32));
        scene.materials.push(Material::diffuse("ball", Vec3::splat(0.3 + 0.03 * mesh as f32)));
    }
    for number in 0..EDGE * EDGE {
        let place = Vec3::new((number % EDGE) as f32, 0.0, (number / EDGE) as f32);
        scene.instances.push(Instance {
            name: format!("ball {number}"),
            mesh: number % MESHES,
            material: number % MESHES,
            world_from_local: Mat4::from_translation(place),
            is_static: number > 0,
            ..Instance::default()
        });
    }
    scene.lights.push(Light {
        kind: LightKind::Directional,
        intensity: 10_000.0,
        direction: Vec3::new(-0.3, -1.0, -0.2).normalize(),
        ..Light::default()
    });
    let middle = Vec3::new(EDGE as f32 / 2.0, 0.0, EDGE as f32 / 2.0);
    scene.cameras.push(Camera::look_at(middle + Vec3::new(0.0, 40.0, 60.0), middle, 0.8));
    scene
}

/// CPU time of this thread so far.
#[cfg(target_os = "linux")]
fn cpu_time() -> Duration {
    let time = rustix::time::clock_gettime(rustix::time::ClockId::ThreadCPUTime);
    Duration::new(time.tv_sec as u64, time.tv_nsec as u32)
}

/// Elsewhere the elapsed time, including waits.
#[cfg(not(target_os = "linux"))]
fn cpu_time() -> Duration {
    static START: std::sync::LazyLock<std::time::Instant> =
        std::sync::LazyLock::new(std::time::Instant::now);
    START.elapsed()
}

/// The median time of a step, ms.
fn median(mut step: impl FnMut() -> f64) -> f64 {
    let mut times: Vec<f64> = (0..FRAMES).map(|_| step()).collect();
    times.sort_unstable_by(f64::total_cmp);
    times[FRAMES / 2]
}

fn measured(step: impl FnOnce()) -> f64 {
    let start = cpu_time();
    step();
    cpu_time().saturating_sub(start).as_secs_f64() * 1000.0
}

fn main() {
    let gpu = pollster::block_on(Gpu::new(&GpuOptions::default())).expect("there is a GPU");
    println!("{}", lumivox_render::describe(&gpu.adapter_info));
    let settings = RenderSettings {
        size: UVec2::new(64, 36),
        resolution: 64,
        frames: 65_536,
        bounces: 1,
        ..RenderSettings::default()
    };
    let mut explorer = Explorer::new(gpu, settings, PresetChoice::default());
    let options = SightOptions { staging: Staging::None, ..SightOptions::default() };
    explorer.open(PreparedScene::new(scene(), &options, &mut |_| {}).expect("the scene is valid"));
    let frame = |explorer: &mut Explorer| {
        pollster::block_on(explorer.frame(&mut |_| {})).expect("a frame is rendered");
    };
    frame(&mut explorer);
    let triangles = explorer.scene().map_or(0, Scene::triangle_count);
    println!("{} objects, {triangles} triangles", EDGE * EDGE);
    println!("still   {:7.3} ms", median(|| measured(|| frame(&mut explorer))));
    let mut height = 0.0_f32;
    let mut move_one = |explorer: &mut Explorer| {
        height = if height > 0.5 { 0.0 } else { height + 0.01 };
        explorer.set_local_edit(0, Mat4::from_translation(Vec3::Y * height));
    };
    let mut update = Vec::new();
    let moving = median(|| {
        measured(|| {
            move_one(&mut explorer);
            update.push(measured(|| {
                pollster::block_on(explorer.update(&mut |_| {})).expect("the scene is taken");
            }));
            frame(&mut explorer);
        })
    });
    update.sort_unstable_by(f64::total_cmp);
    println!("moving  {moving:7.3} ms");
    println!("  update {:6.3} ms", update[update.len() / 2]);
}
