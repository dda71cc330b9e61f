//! Tests that cascades follow the camera, and then give the picture of a new renderer.

use glam::{Mat4, UVec2, Vec3};
use lumivox::{CascadeOptions, TraceSettings, VolumeKind};
use lumivox_render::{Gpu, Picture, RenderSettings, Renderer, View};
use lumivox_scene::{Camera, Light, LightKind, Material, Picker, Scene};

use crate::common::{builtin, gpu, mean_luminance, picture, renderer, zoo};

/// Boxes of 1.3 m, 2.6 m and so on in a room of 2 m.
fn settings() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 36),
        frames: 2,
        bounces: 8,
        shadow_resolution: 256,
        volume: VolumeKind::Cascades,
        cascades: CascadeOptions { count: 4, resolution: 32, voxel_size_m: 0.04 },
        view: View::Diffuse,
        ..RenderSettings::default()
    }
}

/// The Cornell box from a place within it.
fn seen_from(scene: &Scene, position: Vec3) -> Camera {
    Camera { position, ..scene.cameras[0].clone() }
}

fn new_picture(gpu: &Gpu, scene: &Scene, camera: &Camera, settings: &RenderSettings) -> Picture {
    let progress = &mut |_| {};
    let new = Renderer::new(gpu, scene, Some(camera), settings.clone(), progress);
    picture(&mut pollster::block_on(new).expect("a renderer"))
}

/// After the camera has moved, a still picture is bit-identical to a new renderer's.
#[test]
#[ignore = "slow: over three seconds"]
fn a_moved_camera_matches_a_fresh_renderer() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let settings = settings();
    let mut moved = renderer(&gpu, &scene, settings.clone());
    picture(&mut moved);
    let before = *moved.gi().grid();
    let camera = seen_from(&scene, Vec3::new(0.3, 0.9, 0.9));
    moved.set_camera(camera.clone());
    let shown = picture(&mut moved);
    assert_ne!(before, *moved.gi().grid(), "the boxes have not moved");
    assert!(shown.hdr == new_picture(&gpu, &scene, &camera, &settings).hdr);
}

/// The boxes follow a moving camera frame by frame. Afterwards, light stays near that of a new
/// renderer.
#[test]
#[ignore = "slow: over three seconds"]
fn cascades_follow_a_moving_camera() {
    let gpu = gpu();
    let scene = builtin("cornell");
    let trace = TraceSettings { temporal: true, ..TraceSettings::default() };
    let settings = RenderSettings { trace, frames: 1, ..settings() };
    let mut moving = renderer(&gpu, &scene, settings.clone());
    let mut grids = vec![*moving.gi().grid()];
    let to = Vec3::new(0.0, 1.0, 0.8);
    let from = scene.cameras[0].position;
    let mut darkest = f64::MAX;
    let mut brightest = 0.0_f64;
    for step in 1..=26_u8 {
        let share = (f32::from(step) / 12.0).min(1.0);
        moving.set_camera(seen_from(&scene, from.lerp(to, share)));
        let shown = picture(&mut moving);
        if *moving.gi().grid() != grids[grids.len() - 1] {
            grids.push(*moving.gi().grid());
        }
        if step > 12 {
            let luminance = mean_luminance(&shown);
            (darkest, brightest) = (darkest.min(luminance), brightest.max(luminance));
        }
    }
    println!("{} places, {darkest:.4} to {brightest:.4}", grids.len());
    assert!(grids.len() > 4, "the boxes have stayed behind: {}", grids.len());
    let camera = seen_from(&scene, to);
    let still = RenderSettings { frames: 16, ..settings };
    let expected = mean_luminance(&new_picture(&gpu, &scene, &camera, &still));
    println!("of a new one: {expected:.4}");
    assert!(darkest / expected > 0.95 && brightest / expected < 1.05, "not near {expected}");
}

/// Two fences 1 m high, 1 km apart, on a ground of 4 km, with a sun behind them. In the map of the
/// whole ground, texels have 4 m, so a fence casts a shadow only if the finest boxes, which move
/// with the camera, are around it.
#[test]
#[ignore = "slow: over three seconds"]
fn fine_shadows_follow_a_moving_camera() {
    let mut scene = Scene::default();
    let grey = || Material::diffuse("grey", Vec3::splat(0.5));
    let ground = zoo::quad(Vec3::ZERO, Vec3::Z * 2000.0, Vec3::X * 2000.0);
    zoo::place(&mut scene, ground, grey(), Mat4::IDENTITY);
    for fence in [0.0, 1000.0] {
        let fence = zoo::quad(Vec3::new(fence, 0.5, 0.0), Vec3::X * 3.0, Vec3::Y * 0.5);
        zoo::place(&mut scene, fence, grey(), Mat4::IDENTITY);
    }
    scene.lights.push(Light {
        direction: Vec3::new(0.0, -0.5, 1.0).normalize(),
        kind: LightKind::Directional,
        intensity: 1e4,
        ..Light::default()
    });
    let trace = TraceSettings { temporal: true, ..TraceSettings::default() };
    let cascades = CascadeOptions { count: 4, resolution: 32, voxel_size_m: 0.125 };
    let settings =
        RenderSettings { trace, cascades, frames: 1, shadow_resolution: 1024, ..settings() };
    let seen_from = |x: f32| Camera { position: Vec3::new(x, 1.0, 4.0), ..Camera::default() };
    let gpu = gpu();
    let (from, progress) = (seen_from(0.0), &mut |_| {});
    let new = Renderer::new(&gpu, &scene, Some(&from), settings, progress);
    let mut moving = pollster::block_on(new).expect("a renderer");
    // Whether the sun reaches points in the shade of a fence, and away from it.
    let has_sun = |renderer: &Renderer, fence: f32| {
        let places = [Vec3::new(fence, 0.0, 0.5), Vec3::new(fence, 0.0, 8.0)];
        let light = renderer.irradiance(&places, &[Vec3::Y; 2], 1);
        let light = pollster::block_on(light).expect("light");
        [light[0].direct.x > 0.0, light[1].direct.x > 0.0]
    };
    assert_eq!(has_sun(&moving, 0.0), [false, true]);
    assert_eq!(has_sun(&moving, 1000.0), [true, true], "the finest boxes are elsewhere");
    for step in 1..=8_u8 {
        moving.set_camera(seen_from(1000.0 * (f32::from(step) / 4.0).min(1.0)));
        picture(&mut moving);
    }
    assert_eq!(has_sun(&moving, 1000.0), [false, true]);
}

/// Beyond the maps around cascades, shadows on screen are as fine as without cascades.
#[test]
fn shadows_beyond_cascades_match_a_dense_volume() {
    let mut scene = Scene::default();
    let grey = || Material::diffuse("grey", Vec3::splat(0.5));
    let ground = zoo::quad(Vec3::ZERO, Vec3::Z * 500.0, Vec3::X * 500.0);
    zoo::place(&mut scene, ground, grey(), Mat4::IDENTITY);
    let fence = zoo::quad(Vec3::Y, Vec3::X * 3.0, Vec3::Y);
    zoo::place(&mut scene, fence, grey(), Mat4::IDENTITY);
    scene.lights.push(Light {
        direction: Vec3::new(0.0, -0.5, 1.0).normalize(),
        kind: LightKind::Directional,
        intensity: 1e4,
        ..Light::default()
    });
    let cascades = CascadeOptions { count: 3, resolution: 32, voxel_size_m: 0.125 };
    let camera = Camera {
        position: Vec3::new(0.0, 8.0, 30.0),
        forward: Vec3::new(0.0, -8.0, -30.0).normalize(),
        vertical_fov_rad: 0.3,
        ..Camera::default()
    };
    let gpu = gpu();
    let shown = |volume| {
        let settings = RenderSettings { cascades, volume, view: View::Shadow, ..settings() };
        new_picture(&gpu, &scene, &camera, &settings)
    };
    let [dense, cascades] = [VolumeKind::Dense, VolumeKind::Cascades].map(shown);
    let shaded = dense.hdr.iter().filter(|pixel| pixel[0] < 0.5).count();
    assert!(shaded > 40, "{shaded} pixels in the shade");
    assert!(dense.hdr == cascades.hdr);
}

/// Points on the surfaces that a camera sees, with their normals, up to a distance in metres.
fn seen_places(scene: &Scene, camera: &Camera, farthest_m: f32) -> (Vec<Vec3>, Vec<Vec3>) {
    let picker = Picker::new(scene);
    let size = UVec2::new(24, 14);
    let pixels = (0..size.x).flat_map(|x| (0..size.y).map(move |y| UVec2::new(x, y)));
    let picks = pixels.filter_map(|pixel| {
        let (eye, direction) = camera.ray(pixel.as_vec2() + 0.5, size);
        picker.pick(eye, direction).filter(|met| met.distance_m < farthest_m)
    });
    picks.map(|met| (met.position, met.normal)).unzip()
}

/// Compares indirect light at the same points for two camera positions: the relative change of the
/// mean, and the mean and the 95th percentile of the differences, as shares of the mean.
fn change(before: &[f32], after: &[f32]) -> [f32; 3] {
    let mean = |values: &[f32]| values.iter().sum::<f32>() / values.len() as f32;
    let both = before.iter().zip(after);
    let mut differences: Vec<f32> = both.map(|(a, b)| (a - b).abs() / mean(before)).collect();
    differences.sort_by(f32::total_cmp);
    let p95 = differences[differences.len() * 95 / 100];
    [mean(after) / mean(before) - 1.0, mean(&differences), p95]
}

/// If boxes move, and points change to another box, the light at these points hardly changes.
/// `./test --full` has the Cornell box (`cascades_follow_a_moving_camera`).
#[test]
#[ignore = "release: a city of a kilometre"]
fn moving_cascades_keep_a_citys_light_at_release() {
    let gpu = gpu();
    let scene = builtin("city");
    let settings = RenderSettings {
        size: UVec2::new(32, 18),
        frames: 1,
        bounces: 3,
        shadow_resolution: 8192,
        volume: VolumeKind::Cascades,
        view: View::Diffuse,
        ..RenderSettings::default()
    };
    let street = scene.cameras[0].clone();
    let mut city = renderer(&gpu, &scene, settings);
    let mut light = |along_m: f32, (places, normals): &(Vec<Vec3>, Vec<Vec3>)| {
        let position = street.position + Vec3::X * along_m;
        city.set_camera(Camera { position, ..street.clone() });
        picture(&mut city);
        let grid = *city.gi().grid();
        let light = pollster::block_on(city.irradiance(places, normals, 64)).expect("light");
        let light: Vec<f32> = light.iter().map(|at| at.indirect.element_sum() / 3.0).collect();
        (light, grid)
    };
    let places = seen_places(&scene, &scene.cameras[0], 120.0);
    let (before, grid) = light(0.0, &places);
    // llvmpipe: 0.4 % of the mean and p95 3.8 % if nearly all points stay in their boxes; 0.9 % and
    // 9.3 % if most points within 30 m change to another box. The 95th percentile is of single
    // points, which may be at a voxel's edge.
    let moves =
        [(1.05, "one move of the finest box", 1.0, 5.0), (8.1, "moves of four boxes", 3.0, 15.0)];
    for (along_m, name, most_of_mean, most_of_p95) in moves {
        let (after, moved) = light(along_m, &places);
        assert_ne!(grid, moved);
        let [bias, mean, p95] = change(&before, &after).map(|share| 100.0 * share);
        println!("{name}: {bias:+.2} % of the mean, {mean:.2} % on average, p95 {p95:.2} %");
        assert!(bias.abs() < most_of_mean && p95 < most_of_p95, "{name}: {bias} %, {p95} %");
    }
}

/// Far from the origin, a wall leaks no more light than near it.
#[test]
#[ignore = "slow: two rooms twice"]
fn walls_leak_no_more_far_from_the_origin() {
    let gpu = gpu();
    let mut scene = builtin("two-rooms-closed");
    let settings = RenderSettings {
        cascades: CascadeOptions { count: 5, resolution: 64, voxel_size_m: 1.0 / 64.0 },
        ..settings()
    };
    let leak = |scene: &Scene| {
        let [dark, lit] = ["dark room", "lit room"].map(|room| {
            let camera = crate::common::camera(scene, room);
            mean_luminance(&new_picture(&gpu, scene, &camera, &settings))
        });
        dark / lit
    };
    let near = leak(&scene);
    scene.transform(Mat4::from_translation(Vec3::new(1000.0, 0.0, -1000.0)));
    let far = leak(&scene);
    println!("{:.2} % near the origin, {:.2} % far away", 100.0 * near, 100.0 * far);
    assert!((far - near).abs() < 0.002, "{near} near the origin, {far} far away");
}
