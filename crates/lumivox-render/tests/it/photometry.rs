//! Tests of the light at a pixel against closed forms and the picture.

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{Mat4, UVec2, Vec3};
use lumivox_render::{Exposure, Photometry, RenderSettings, Renderer, View};
use lumivox_scene::{Camera, EnvironmentMap, Light, LightKind, Material, Scene, Shading};

use crate::common::{builtin, gpu, picture, renderer, zoo};

fn small() -> RenderSettings {
    RenderSettings {
        size: UVec2::new(48, 32),
        resolution: 32,
        frames: 8,
        ..RenderSettings::default()
    }
}

fn measured(renderer: &Renderer, x: u32, y: u32) -> Option<Photometry> {
    pollster::block_on(renderer.photometry(UVec2::new(x, y))).expect("a device at work")
}

/// A floor of 20 % albedo, 10 m wide, and a lamp of 100 cd two metres above its middle.
fn lamp_over_floor() -> Scene {
    let mut scene = Scene::default();
    let floor = zoo::quad(Vec3::ZERO, Vec3::X * 5.0, Vec3::NEG_Z * 5.0);
    zoo::place(&mut scene, floor, Material::diffuse("floor", Vec3::splat(0.2)), Mat4::IDENTITY);
    scene.lights.push(Light { intensity: 100.0, position: Vec3::Y * 2.0, ..Light::default() });
    scene.cameras.push(Camera::look_at(Vec3::Y * 1.0, Vec3::ZERO, 1.0));
    scene
}

#[test]
#[ignore = "slow: over three seconds"]
fn a_lamp_lights_the_floor_by_the_inverse_square() {
    let mut renderer = renderer(&gpu(), &lamp_over_floor(), small());
    assert_eq!(measured(&renderer, 24, 16), None, "no frame yet");
    let picture = picture(&mut renderer);
    let below = measured(&renderer, 24, 16).expect("a surface");
    let lux = below.illuminance_lux.expect("a surface");
    // 100 cd / (2 m)² from the only source; tolerance for half a pixel off the centre, and half
    // floats.
    assert!((lux / 25.0 - 1.0).abs() < 2e-3, "{lux} lux");
    // The albedo has 8 bits.
    assert!((below.luminance_cd_m2 / (0.2 / PI * lux) - 1.0).abs() < 0.02, "{below:?}");
    let [r, g, b, _] = picture.hdr[16 * 48 + 24];
    let seen = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    assert!((below.luminance_cd_m2 / seen - 1.0).abs() < 1e-5, "{below:?}, {seen}");
    assert_eq!(measured(&renderer, 48, 0), None, "beyond the picture");
}

/// In the furnace, radiance is 2 cd/m² everywhere, so illuminance is pi times as much; to its
/// emission of 1 cd/m² a surface adds albedo / pi times the illuminance.
#[test]
fn illuminance_includes_indirect_light_of_all_frames() {
    let settings = RenderSettings { bounces: 12, ..small() };
    let mut renderer = renderer(&gpu(), &builtin("furnace"), settings);
    picture(&mut renderer);
    for (x, y) in [(3, 3), (24, 16), (40, 28), (10, 20)] {
        let here = measured(&renderer, x, y).expect("a wall");
        let lux = here.illuminance_lux.expect("a wall");
        // Noisy: eight points a frame sample all walls.
        assert!((4.6..7.6).contains(&lux), "{lux} lux at {x}, {y}");
        let by_luminance = (here.luminance_cd_m2 - 1.0) * PI / 0.5;
        assert!(
            (lux / by_luminance - 1.0).abs() < 0.01,
            "{lux} and {by_luminance} lux at {x}, {y}"
        );
    }
}

#[test]
fn unlit_pixels_have_no_illuminance() {
    let mut scene = lamp_over_floor();
    scene.environment.radiance = Vec3::splat(3.0);
    scene.cameras[0] = Camera::look_at(Vec3::Y, Vec3::Y * 2.0 + Vec3::NEG_Z, 1.0);
    let mut at_the_sky = renderer(&gpu(), &scene, small());
    picture(&mut at_the_sky);
    let sky = measured(&at_the_sky, 24, 2).expect("the sky is bright");
    assert_eq!(sky.illuminance_lux, None);
    assert!((sky.luminance_cd_m2 - 3.0).abs() < 0.01, "{sky:?}");

    let views = [(View::Direct, true), (View::Normal, false)];
    for (view, is_light) in views {
        let settings = RenderSettings { view, exposure: Exposure::Stops(0.0), ..small() };
        let mut renderer = renderer(&gpu(), &lamp_over_floor(), settings);
        picture(&mut renderer);
        let here = measured(&renderer, 24, 16);
        assert_eq!(here.is_some(), is_light, "{view:?}");
        assert_eq!(here.and_then(|here| here.illuminance_lux), None, "{view:?}");
    }
}

/// A mirroring ball of radius R scatters the light of a sun evenly: E R² / 4 per steradian. At this
/// size the highlight covers a fifth of a pixel. Half floats could store 30 % of it, and the
/// panorama's map cannot store the sun.
#[test]
#[ignore = "slow: over three seconds"]
fn a_highlight_smaller_than_a_pixel_keeps_its_energy() {
    let to_sun = Vec3::new(0.3, 0.4, 1.0).normalize();
    let mut scene = Scene::default();
    let mut metal = Material::diffuse("metal", Vec3::ONE);
    if let Shading::MetallicRoughness(shading) = &mut metal.shading {
        (shading.metallic, shading.roughness) = (1.0, 0.1);
    }
    let radius_m = 0.1;
    let scale = Mat4::from_scale(Vec3::splat(radius_m / zoo::RADIUS_M));
    zoo::place(&mut scene, zoo::sphere(), metal, scale);
    let (distance_m, fov) = (2.0, 0.12_f32);
    scene.cameras.push(Camera::look_at(Vec3::Z * distance_m, Vec3::ZERO, fov));
    let mut in_panorama = scene.clone();
    let (kind, intensity) = (LightKind::Directional, 1000.0);
    scene.lights.push(Light { kind, intensity, direction: -to_sun, ..Light::default() });
    let (panorama, illuminance_lux) = sun_in_panorama(to_sun);
    in_panorama.environment = Arc::new(panorama).into();
    for (scene, illuminance_lux) in [(scene, 1000.0), (in_panorama, illuminance_lux)] {
        let expected = illuminance_lux * radius_m * radius_m / 4.0;
        for (frames, tolerance) in [(1, 0.1), (8, 0.05)] {
            let size = UVec2::splat(48);
            let settings = RenderSettings { size, frames, view: View::Direct, ..small() };
            let picture = picture(&mut renderer(&gpu(), &scene, settings));
            let sum: f32 = picture.hdr.iter().map(|pixel| pixel[1]).sum();
            let pixel_m = 2.0 * distance_m * (fov / 2.0).tan() / size.y as f32;
            let ratio = sum * pixel_m * pixel_m / expected;
            println!("the highlight in {frames} frames over the closed form: {ratio}");
            assert!((ratio - 1.0).abs() < tolerance, "{frames}: {ratio}");
        }
    }
}

/// A panorama that is black except for a sun of 1.5 degrees radius, and the sun's illuminance.
fn sun_in_panorama(to_sun: Vec3) -> (EnvironmentMap, f32) {
    let (width, height) = (512_u32, 256_u32);
    let mut illuminance_lux = 0.0;
    let mut texel = |x: u32, y: u32| {
        let (longitude, colatitude) =
            ((x as f32 + 0.5) / width as f32 * 2.0 * PI, (y as f32 + 0.5) / height as f32 * PI);
        let (sin, cos) = colatitude.sin_cos();
        let cosine = Vec3::new(-sin * longitude.sin(), cos, sin * longitude.cos()).dot(to_sun);
        let radiance = if cosine > 1.5_f32.to_radians().cos() { 1e5 } else { 0.0 };
        illuminance_lux += radiance * cosine * sin * (PI / height as f32).powi(2);
        [radiance; 3]
    };
    let rgb = (0..width * height).map(|i| texel(i % width, i / width)).collect();
    (EnvironmentMap { width, height, rgb, ..EnvironmentMap::default() }, illuminance_lux)
}
