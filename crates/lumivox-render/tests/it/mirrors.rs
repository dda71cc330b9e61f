//! Tests of mirrors and metals.

use glam::{UVec2, Vec3};
use lumivox_render::{Picture, RenderSettings, View};
use lumivox_scene::builtin::shapes::{quad, sphere};
use lumivox_scene::{Camera, Environment, Instance, Scene};

use crate::common::{builtin, gpu, metal, picture, renderer};

/// The share of pixels in the mirror whose light differs by more than 3 % from that of the pixels
/// in `behind`, a picture of the same surfaces without the mirror.
fn unlike(mirror: &Picture, albedo: &Picture, behind: &Picture) -> f64 {
    let UVec2 { x: width, y: height } = mirror.size;
    let (mut all, mut unlike) = (0_u32, 0_u32);
    for (x, y) in (0..height).flat_map(|y| (0..width).map(move |x| (x, y))) {
        let [here, there] = [x, width - 1 - x].map(|x| (y * width + x) as usize);
        // Metals have no albedo.
        let is_mirror = albedo.hdr[here][3] >= 1.0 && albedo.hdr[here][..3] == [0.0; 3];
        if is_mirror && behind.hdr[there][3] >= 1.0 {
            let is_like = |channel: usize| {
                let [ours, its] = [mirror.hdr[here][channel], behind.hdr[there][channel]];
                (ours - its).abs() <= 0.03 * its
            };
            all += 1;
            unlike += u32::from(!(0..3).all(is_like));
        }
    }
    assert!(all > 1000, "only {all} pixels show the mirror");
    f64::from(unlike) / f64::from(all)
}

/// A mirror as the back wall of the Cornell box shows what a camera behind the wall would see. On
/// llvmpipe 11 % of the pixels differ, most of them at edges; 55 % if mirrors show whole faces.
#[test]
#[ignore = "slow: over three seconds"]
fn a_mirror_shows_what_a_camera_behind_it_sees() {
    let mut scene = builtin("cornell");
    scene.instances.retain(|instance| instance.name != "tall block");
    let mirror = scene.materials.len();
    scene.materials.push(metal(0.0));
    let wall = quad(Vec3::new(0.0, 1.0, -0.999), Vec3::X, Vec3::Y);
    scene.meshes.push(wall);
    let mesh = scene.meshes.len() - 1;
    scene.instances.push(Instance {
        name: "mirror".to_owned(),
        mesh,
        material: mirror,
        ..Instance::default()
    });
    let seen = |view| RenderSettings {
        size: UVec2::splat(96),
        resolution: 64,
        frames: 8,
        view,
        ..RenderSettings::default()
    };
    let front = Camera::look_at(Vec3::Y, Vec3::new(0.0, 1.0, -1.0), 1.4);
    let mut behind = Camera::look_at(Vec3::new(0.0, 1.0, 2.0 * -0.999), Vec3::Y, 1.4);
    behind.near_m = 1.0;
    let show = |camera: &Camera, view| {
        let mut renderer = renderer(&gpu(), &scene, seen(view));
        renderer.set_camera(camera.clone());
        picture(&mut renderer)
    };
    let [mirror, albedo] = [View::Final, View::Albedo].map(|view| show(&front, view));
    let share = unlike(&mirror, &albedo, &show(&behind, View::Final));
    println!("{:.1} % of the mirror is unlike", 100.0 * share);
    assert!(share < 0.2, "{share}");
}

/// Rough metals lose no light between their microfacets: a white ball in even light is not seen.
#[test]
fn a_white_metal_reflects_all_light() {
    for roughness in [0.1, 0.3, 0.7, 1.0] {
        let mut scene = Scene {
            environment: Environment { radiance: Vec3::ONE, ..Environment::default() },
            ..Scene::default()
        };
        scene.materials.push(metal(roughness));
        scene.meshes.push(sphere(1.0, 48));
        scene.instances.push(Instance::default());
        let settings = RenderSettings {
            size: UVec2::splat(32),
            resolution: 32,
            frames: 8,
            ..RenderSettings::default()
        };
        let mut renderer = renderer(&gpu(), &scene, settings);
        renderer.set_camera(Camera::look_at(Vec3::Z * 7.2, Vec3::ZERO, 0.3));
        let pixels = picture(&mut renderer).hdr;
        let ball: Vec<f32> = pixels.iter().filter(|p| p[3] >= 1.0).map(|p| p[1]).collect();
        let mean = ball.iter().sum::<f32>() / ball.len() as f32;
        assert!((mean - 1.0).abs() < 0.015, "roughness {roughness}: {mean}");
    }
}
