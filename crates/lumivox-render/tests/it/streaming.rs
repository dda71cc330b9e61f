//! Tests of geometry that is streamed with the camera, within a budget of GPU memory.

use std::ops::ControlFlow;

use glam::{Mat4, UVec2, Vec3, Vec4};
use lumivox::{CascadeOptions, TraceSettings, VolumeKind};
use lumivox_render::{
    GeometryBudget, Gpu, RenderError, RenderSettings, Renderer, StreamedGeometry,
};
use lumivox_scene::{Camera, Environment, Instance, Material, Mesh, Scene};

use crate::common::{gpu, mean_luminance, picture, renderer};

const TILES: u32 = 24;
const TILE_M: f32 = 4.0;
/// Quads along each edge of a tile, whose vertices nearly fill a batch.
const QUADS: u32 = 64;
/// The size of a few tiles, bytes.
const BUDGET: u64 = 2 << 20;

/// A row of hilly tiles along x, each a separate mesh, with a red post on every fourth tile.
fn way() -> Scene {
    let mut scene = Scene {
        environment: Environment { radiance: Vec3::splat(100.0), ..Environment::default() },
        materials: vec![Material::default()],
        ..Scene::default()
    };
    for tile in 0..TILES {
        let mesh = scene.meshes.len();
        scene.meshes.push(hills(tile));
        let along = TILE_M * tile as f32;
        scene.instances.push(Instance {
            mesh,
            world_from_local: Mat4::from_translation(Vec3::X * along),
            is_static: true,
            ..Instance::default()
        });
    }
    scene.cameras.push(camera(6.0));
    scene
}

fn hills(tile: u32) -> Mesh {
    let height = |x: f32, z: f32| 0.15 * ((3.0 + 0.1 * tile as f32) * x).sin() * (2.5 * z).cos();
    let edge = QUADS + 1;
    let places = (0..edge * edge).map(|i| UVec2::new(i % edge, i / edge).as_vec2());
    let places = places.map(|place| place * (TILE_M / QUADS as f32));
    let positions: Vec<Vec3> =
        places.map(|place| Vec3::new(place.x, height(place.x, place.y), place.y)).collect();
    let quads = (0..QUADS * QUADS).map(|i| i % QUADS + i / QUADS * edge);
    let indices = quads.flat_map(|a| [a, a + edge, a + 1, a + 1, a + edge, a + edge + 1]).collect();
    Mesh {
        name: format!("tile {tile}"),
        normals: vec![Vec3::Y; positions.len()],
        colors: vec![Vec4::new(0.7, 0.5 + 0.02 * tile as f32, 0.4, 1.0); positions.len()],
        positions,
        indices,
        ..Mesh::default()
    }
}

/// A camera above the tiles that looks down.
fn camera(along_m: f32) -> Camera {
    let eye = Vec3::new(along_m, 2.5, 0.5 * TILE_M);
    Camera::look_at(eye, eye + Vec3::new(0.8, -1.5, 0.0), 0.9)
}

fn settings(geometry_budget: Option<u64>) -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 36),
        frames: 2,
        bounces: 8,
        shadow_resolution: 64,
        volume: VolumeKind::Cascades,
        cascades: CascadeOptions { count: 3, resolution: 32, voxel_size_m: 0.1 },
        geometry_budget,
        ..RenderSettings::default()
    }
}

fn streamed(renderer: &Renderer) -> StreamedGeometry {
    renderer.streamed().expect("there is a budget")
}

fn new_at(gpu: &Gpu, scene: &Scene, camera: &Camera, settings: RenderSettings) -> Renderer {
    let progress = &mut |_| {};
    let new = Renderer::new(gpu, scene, Some(camera), settings, progress);
    pollster::block_on(new).expect("a renderer")
}

/// The nearest geometry is resident, within the budget, and the missing part is reported. If that
/// part is invisible, the picture is nearly that of the whole scene; if everything fits the budget,
/// both are equal.
#[test]
#[ignore = "slow: over three seconds"]
fn near_geometry_is_resident_and_the_rest_is_reported() {
    let (gpu, scene) = (gpu(), way());
    let whole = picture(&mut renderer(&gpu, &scene, settings(None)));
    let mut all = renderer(&gpu, &scene, settings(Some(1 << 30)));
    assert!(picture(&mut all).hdr == whole.hdr);
    let StreamedGeometry { bytes, resident_bytes, triangles, .. } = streamed(&all);
    assert_eq!((bytes, triangles), (resident_bytes, u64::from(TILES * QUADS * QUADS * 2)));
    assert!(bytes > 3 * BUDGET, "{bytes}");

    let mut near = renderer(&gpu, &scene, settings(Some(BUDGET)));
    let shown = picture(&mut near);
    let figures = streamed(&near);
    assert!(figures.resident_bytes <= BUDGET && !figures.is_late, "{figures:?}");
    assert!(figures.resident_triangles > 0 && figures.resident_triangles < triangles);
    let vertices = near.memory().into_iter().find(|use_| use_.name == "vertices and indices");
    assert!(vertices.is_some_and(|vertices| vertices.bytes <= BUDGET + (1 << 16)));
    let [whole, shown] = [&whole, &shown].map(mean_luminance);
    assert!((shown / whole - 1.0).abs() < 0.02, "{shown} of {whole}");
}

/// After the camera has moved, a still picture is bit-identical to a new renderer's.
#[test]
#[ignore = "slow: over three seconds"]
fn streamed_geometry_matches_a_fresh_renderer_after_moving() {
    let (gpu, scene) = (gpu(), way());
    let mut moved = renderer(&gpu, &scene, settings(Some(BUDGET)));
    picture(&mut moved);
    let there = camera(80.0);
    moved.set_camera(there.clone());
    let shown = picture(&mut moved);
    let mut new = new_at(&gpu, &scene, &there, settings(Some(BUDGET)));
    assert!(shown.hdr == picture(&mut new).hdr);
    assert_eq!(streamed(&moved), streamed(&new));
    assert!(mean_luminance(&shown) > 1.0, "nothing is there");
}

/// In motion, no frame fails or exceeds the budget, and the ground below the camera is always
/// resident.
#[test]
#[ignore = "slow: over three seconds"]
fn geometry_streams_in_around_a_moving_camera() {
    let (gpu, scene) = (gpu(), way());
    let trace = TraceSettings { temporal: true, ..TraceSettings::default() };
    let settings = RenderSettings { trace, frames: 1, ..settings(Some(BUDGET)) };
    let mut moving = renderer(&gpu, &scene, settings.clone());
    let mut darkest = f64::MAX;
    // The camera passes over seven tiles.
    for step in 0..30_u8 {
        moving.set_camera(camera(6.0 + f32::from(step)));
        pollster::block_on(moving.render_frame()).expect("a frame");
        assert!(streamed(&moving).resident_bytes <= BUDGET);
        let frame = pollster::block_on(moving.finish()).expect("a picture");
        darkest = darkest.min(mean_luminance(&frame));
    }
    let there = camera(35.0);
    let expected = mean_luminance(&picture(&mut new_at(&gpu, &scene, &there, settings)));
    // How many frames the last voxels are late varies with the load of the machine; their light
    // takes a few more.
    moving.set_camera(there);
    let keeps_on = &mut |_| ControlFlow::Continue(());
    let arrived = pollster::block_on(moving.render_more(12, keeps_on)).expect("a picture");
    let arrived = mean_luminance(&arrived.expect("nothing stops it"));
    println!("{darkest:.2} at least, {arrived:.2} in the end, {expected:.2} of a new one");
    assert!(darkest > 0.6 * expected, "a hole: {darkest} of {expected}");
    assert!((arrived / expected - 1.0).abs() < 0.05, "{arrived}, not {expected}");
}

/// A renderer's budget cannot change. Scenes can also be uploaded with a budget without a renderer.
#[test]
#[ignore = "slow: over three seconds"]
fn changing_the_geometry_budget_needs_a_new_renderer() {
    let (gpu, scene) = (gpu(), way());
    let mut near = renderer(&gpu, &scene, settings(Some(BUDGET)));
    let progress = &mut |_| {};
    let other = near.set_settings(settings(None), progress);
    let error = pollster::block_on(other).expect_err("it has another budget");
    assert!(matches!(&error, RenderError::Setting { name: "geometry_budget", .. }), "{error}");
    let budget = GeometryBudget { bytes: BUDGET, camera: Vec3::ZERO };
    let lighting = lumivox_render::Lighting::of(&scene);
    let uploaded =
        lumivox_render::GpuScene::new(&gpu, &scene, &lighting, 1.0, Some(budget)).expect("it fits");
    let shown = uploaded.draws.iter().filter(|draw| !draw.indices.is_empty()).count();
    assert!(shown > 0 && shown < TILES as usize, "{shown}");
}
