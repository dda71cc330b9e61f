//! Tests that a scene in millimetres or in kilometres gives the picture of the scene in metres:
//! radiance and illuminance do not depend on the unit of length.

use glam::{Mat4, UVec2, Vec3};
use lumivox_render::{Gpu, Picture, RenderSettings, View};
use lumivox_scene::{Camera, Light, LightKind, Material, Scene};

use crate::common::{builtin, gpu, picture, renderer, zoo};

/// The atrium, which has a sun, a sky and textures, enlarged by `scale`.
fn atrium(scale: f32) -> Scene {
    let mut scene = builtin("atrium");
    for instance in &mut scene.instances {
        instance.world_from_local =
            Mat4::from_scale(Vec3::splat(scale)) * instance.world_from_local;
    }
    for camera in &mut scene.cameras {
        let (position, near_m) = (camera.position * scale, camera.near_m * scale);
        *camera = Camera { position, near_m, ..camera.clone() };
    }
    scene.validate().expect("a valid scene");
    scene
}

fn render(gpu: &Gpu, scene: &Scene) -> Picture {
    let size = UVec2::new(64, 36);
    let settings = RenderSettings { size, resolution: 32, frames: 4, ..RenderSettings::default() };
    picture(&mut renderer(gpu, scene, settings))
}

#[test]
#[ignore = "slow: over three seconds"]
fn scaled_scenes_look_the_same() {
    let gpu = gpu();
    let metres = render(&gpu, &atrium(1.0));
    // Powers of two scale exactly, so walls on the borders of voxels stay there. With a factor of
    // 1000, some would move to the other side, which changes the mean like a shift of the grid (1.5
    // % at 32 voxels).
    for scale in [1.0 / 1024.0, 1024.0] {
        let other = render(&gpu, &atrium(scale));
        let mean = |picture: &Picture| -> f64 {
            picture.hdr.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>()
                / picture.hdr.len() as f64
        };
        let bias = mean(&other) / mean(&metres) - 1.0;
        assert!(bias.abs() < 0.001, "at {scale}: {:.3} % off", 100.0 * bias);
        // Near planes and shadow maps are rounded differently, but hardly any pixel of the screen
        // may differ visibly.
        let differing = other
            .ldr
            .iter()
            .zip(&metres.ldr)
            .filter(|(a, b)| a.iter().zip(b.iter()).any(|(a, b)| a.abs_diff(*b) > 8));
        let share = differing.count() as f64 / metres.ldr.len() as f64;
        assert!(share < 0.002, "at {scale}: {:.2} % of the pixels differ", 100.0 * share);
    }
}

/// A board of 40 cm, a metre above 200 m of ground, under a sun at the zenith. Its shadow is as
/// large as a texel of a map of the whole ground, which would blur it.
#[test]
fn a_small_object_on_wide_ground_casts_a_shadow() {
    let mut scene = Scene::default();
    let grey = || Material::diffuse("grey", Vec3::splat(0.5));
    for (height_m, half_m) in [(0.0, 100.0), (1.0, 0.2)] {
        let quad = zoo::quad(Vec3::Y * height_m, Vec3::X * half_m, Vec3::NEG_Z * half_m);
        zoo::place(&mut scene, quad, grey(), Mat4::IDENTITY);
    }
    let (kind, intensity) = (LightKind::Directional, 1000.0);
    scene.lights.push(Light { kind, intensity, ..Light::default() });
    let camera = Camera::look_at(Vec3::new(0.0, 0.5, 4.0), Vec3::ZERO, 0.2);
    scene.cameras.push(camera);
    scene.validate().expect("a valid scene");
    let settings = RenderSettings {
        size: UVec2::new(65, 33),
        resolution: 32,
        frames: 1,
        view: View::Direct,
        shadow_resolution: 512,
        ..RenderSettings::default()
    };
    let seen = picture(&mut renderer(&gpu(), &scene, settings));
    let green = |x: usize| seen.hdr[16 * 65 + x][1];
    // The shadow ends sharply, eight pixels from the centre.
    for (pixel, is_lit) in [(2, true), (18, true), (28, false), (32, false)] {
        assert_eq!(green(pixel) > 120.0, is_lit, "pixel {pixel}: {}", green(pixel));
    }
}
