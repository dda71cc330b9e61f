//! Tests of clear coat, sheen, coloured gloss, and unlit surfaces.

use std::f32::consts::PI;

use glam::{Vec3, Vec4};
use lumivox_render::{RenderSettings, View};
use lumivox_scene::{
    Camera, Clearcoat, Light, LightKind, Material, MetallicRoughness, Scene, Shading, Sheen,
    TextureRef, Unlit, builtin,
};

use crate::surfaces::stage::*;

const ANGLES: [f32; 2] = [0.0, 1.2];

/// A large plane, seen at an angle to its normal.
fn seen_under(angle: f32, material: Material) -> Scene {
    let mut scene = scene();
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 4.0, Vec3::NEG_Z * 4.0), material);
    let away = Vec3::new(angle.sin(), angle.cos(), 0.0);
    scene.cameras = vec![Camera::look_at(away * 1.5, Vec3::ZERO, 0.1)];
    scene
}

fn under_the_sky(angle: f32, material: Material) -> Vec3 {
    let mut scene = seen_under(angle, material);
    scene.environment.radiance = Vec3::ONE;
    mean(&render(&scene, RenderSettings { bounces: 1, frames: 32, ..settings(View::Final) }))
}

fn fresnel(f0: f32, angle: f32) -> f32 {
    f0 + (1.0 - f0) * (1.0 - angle.cos()).powi(5)
}

/// The radiance of a dielectric of albedo 0.5 under a sky of radiance 1: gloss and the diffuse
/// light below it, integrated over directions of light (GGX, height-correlated Smith, Schlick).
fn dielectric_in_even_light(roughness: f32, angle: f32) -> f32 {
    const STEPS: u32 = 256;
    let (alpha_2, view) = (roughness.powi(4), Vec3::new(angle.sin(), 0.0, angle.cos()));
    let lambda = |z: f32| (alpha_2 + (1.0 - alpha_2) * z * z).sqrt();
    let mut sum = 0.0;
    // Uniform in the squared sine and the azimuth: cosine-weighted over the hemisphere.
    for i in 0..STEPS {
        for j in 0..STEPS {
            let sine_2 = (i as f32 + 0.5) / STEPS as f32;
            let azimuth = PI * (j as f32 + 0.5) / STEPS as f32;
            let (sine, z) = (sine_2.sqrt(), (1.0 - sine_2).sqrt());
            let light = Vec3::new(azimuth.cos() * sine, azimuth.sin() * sine, z);
            let half = (view + light).normalize();
            let fresnel = 0.04 + 0.96 * (1.0 - half.dot(view)).powi(5);
            let spread = half.z * half.z * (alpha_2 - 1.0) + 1.0;
            let visibility = 0.5 / (z * lambda(view.z) + view.z * lambda(z));
            let gloss = alpha_2 / (PI * spread * spread) * visibility * fresnel;
            sum += f64::from(0.5 * (1.0 - fresnel) + PI * gloss);
        }
    }
    (sum / f64::from(STEPS * STEPS)) as f32
}

/// From normal to grazing angles, a floor under a uniform sky has the light computed from its BRDF.
#[test]
#[ignore = "slow: over three seconds"]
fn a_dielectric_in_uniform_light_matches_its_brdf() {
    for roughness in [0.3, 1.0] {
        let paint = MetallicRoughness {
            base_color: Vec4::new(0.5, 0.5, 0.5, 1.0),
            roughness,
            ..Default::default()
        };
        for degrees in [0.0_f32, 75.0, 83.0] {
            let found = under_the_sky(degrees.to_radians(), metallic_roughness(paint));
            let expected = dielectric_in_even_light(roughness, degrees.to_radians());
            println!("roughness {roughness}, {degrees} degrees: {found}, expected {expected}");
            assert_near("floor", found / expected, Vec3::ONE, 0.02);
        }
    }
}

/// Walls that glow uniformly light a rough metal like a uniform sky. Points on emitters count for
/// all draws of a pixel, even if a draw's direction is below the surface.
#[test]
#[ignore = "slow: over three seconds"]
fn glowing_walls_light_metal_like_a_uniform_sky() {
    for roughness in [0.6, 1.0] {
        let metal = metallic_roughness(MetallicRoughness {
            base_color: Vec4::new(0.9, 0.9, 0.9, 1.0),
            metallic: 1.0,
            roughness,
            ..Default::default()
        });
        let expected = under_the_sky(0.6, metal.clone());
        let mut scene = seen_under(0.6, metal);
        let glow = Material { emissive: Vec3::ONE, ..Material::diffuse("glow", Vec3::ZERO) };
        let walls =
            builtin::shapes::interior(Vec3::new(-4.0, -0.5, -4.0), Vec3::new(4.0, 3.0, 4.0));
        add(&mut scene, walls, glow);
        let settings = RenderSettings { bounces: 1, frames: 32, ..settings(View::Final) };
        let found = mean(&render(&scene, settings));
        println!("roughness {roughness}: {found}, under a sky {expected}");
        assert_near("metal", found / expected, Vec3::ONE, 0.03);
    }
}

/// A metal reflects the edge of a lamp of one or 256 pairs of triangles: in the first frame nearly
/// as in the mean of many.
#[test]
#[ignore = "slow: over three seconds"]
fn a_metal_reflects_the_edge_of_a_lamp_in_one_frame() {
    let metal = metallic_roughness(MetallicRoughness {
        base_color: Vec4::new(0.9, 0.9, 0.9, 1.0),
        metallic: 1.0,
        roughness: 0.3,
        ..Default::default()
    });
    let glow = Material { emissive: Vec3::ONE, ..Material::diffuse("glow", Vec3::ZERO) };
    let seen = |tiles: u32, frames: u32| {
        let mut scene = seen_under(0.6, metal.clone());
        let size = 2.0 / tiles as f32;
        let at = |i: u32| size * (2.0 * i as f32 + 1.0);
        for (x, z) in (0..tiles).flat_map(|x| (0..tiles).map(move |z| (x, z))) {
            // The lamp's edge is reflected in the middle of the floor.
            let middle = Vec3::new(-2.0 * 0.6_f32.tan() - at(x), 2.0, at(z) - 2.0);
            add(&mut scene, quad(middle, Vec3::X * size, Vec3::Z * size), glow.clone());
        }
        render(&scene, RenderSettings { bounces: 1, frames, ..settings(View::Final) }).hdr
    };
    for (tiles, limit) in [(1, 0.05), (16, 0.12)] {
        let truth = seen(tiles, 64);
        let mean = truth.iter().map(|pixel| pixel[1]).sum::<f32>() / truth.len() as f32;
        let first = seen(tiles, 1);
        let squares = truth.iter().zip(&first).map(|(a, b)| (a[1] - b[1]).powi(2));
        let noise = (squares.sum::<f32>() / truth.len() as f32).sqrt() / mean;
        println!("{tiles} x {tiles} tiles: {mean}, noise {noise}");
        // Half of the lobe hits the lamp.
        assert!((mean / 0.45 - 1.0).abs() < 0.1, "{mean}");
        assert!(noise < limit, "{noise}");
    }
}

fn coat(strength: f32, roughness: f32) -> Clearcoat {
    Clearcoat { strength, roughness, texture: None }
}

/// Varnished metal with a rough normal map, seen at a grazing angle under a sky of radiance 1:
/// mirrored directions of bent normals are above the surface, so that no pixel is black.
#[test]
fn bent_normals_leave_no_dark_rim() {
    for angle in [1.2, 1.5] {
        let mirror = MetallicRoughness { metallic: 1.0, roughness: 0.2, ..Default::default() };
        let material = Material {
            clearcoat: coat(1.0, 0.05),
            normal_texture: Some(TextureRef::new(0)),
            ..metallic_roughness(mirror)
        };
        let mut scene = seen_under(angle, material);
        // Bumps of up to 45 degrees, in all directions.
        scene.textures.push(texture(16, 16, |x, y| {
            let bump = |n: u32| 128 + (((n * 7919) % 180) as i32 - 90);
            [bump(x + 3 * y) as u8, bump(5 * x + 2 * y + 1) as u8, 220, 255]
        }));
        scene.environment.radiance = Vec3::ONE;
        let asked = RenderSettings { bounces: 1, frames: 32, ..settings(View::Final) };
        let picture = render(&scene, asked);
        let dark = picture.hdr.iter().filter(|pixel| pixel[1] < 0.6).count();
        let share = dark as f32 / picture.hdr.len() as f32;
        println!("under {angle}: mean {}, {share} dark", mean(&picture));
        assert!(share < 0.01, "{share} of the pixels are dark under {angle}");
        assert!(mean(&picture).y > 0.85);
    }
}

/// White paint under varnish and a sky of radiance 1: the coat reflects exactly the light that does
/// not reach the paint. On black paint only the coat reflects; on a mirror both lobes are sampled.
#[test]
#[ignore = "slow: over three seconds"]
fn clearcoat_conserves_energy() {
    for angle in ANGLES {
        let reflected = fresnel(0.04, angle);
        let varnished = |albedo: f32, strength: f32| {
            let paint = Material::diffuse("paint", Vec3::splat(albedo));
            under_the_sky(angle, Material { clearcoat: coat(strength, 0.1), ..paint })
        };
        assert_near("white", varnished(1.0, 1.0), Vec3::ONE, 0.02);
        // The tolerance is for a strength of 8 bits, and the lobe's width at grazing angles.
        assert_near("black", varnished(0.0, 1.0), Vec3::splat(reflected), 0.02);
        assert_near("half", varnished(0.0, 0.5), Vec3::splat(0.5 * reflected), 0.01);
        let mirror = metallic_roughness(MetallicRoughness {
            metallic: 1.0,
            roughness: 0.1,
            base_color: Vec4::new(1.0, 0.5, 0.2, 1.0),
            ..MetallicRoughness::default()
        });
        let gold = Vec3::new(1.0, 0.5, 0.2).map(|f0| fresnel(f0, angle));
        let expected = reflected + (1.0 - reflected) * gold;
        let both = under_the_sky(angle, Material { clearcoat: coat(1.0, 0.25), ..mirror });
        // At grazing angles, a rough coat loses the light that it would reflect into the surface.
        assert_near("gold", both, expected, 0.02 + 0.1 * reflected);
    }
}

/// Under a lamp the coat adds a second lobe, compared with the formulas on the CPU.
#[test]
fn clearcoat_has_its_own_highlight() {
    let roughness = 0.5_f32;
    let paint = Material::diffuse("paint", Vec3::splat(0.6));
    for (angle, to_light) in [(0.0, 0.3_f32), (0.8, 0.8)] {
        let material = Material { clearcoat: coat(0.8, roughness), ..paint.clone() };
        let mut scene = seen_under(angle, material);
        let light = Vec3::new(-to_light.sin(), to_light.cos(), 0.0);
        scene.lights.push(Light {
            kind: LightKind::Directional,
            intensity: 100.0,
            direction: -light,
            ..Light::default()
        });
        let picture = render(&scene, RenderSettings { frames: 1, ..settings(View::Direct) });
        let at = 16 * 32 + 16;

        let view = Vec3::new(angle.sin(), angle.cos(), 0.0);
        let half = (view + light).normalize();
        let alpha2 = roughness.powi(4);
        let d = half.y * half.y * (alpha2 - 1.0) + 1.0;
        let distribution = alpha2 / (PI * d * d);
        let lambda = |cosine: f32| (cosine * cosine * (1.0 - alpha2) + alpha2).sqrt();
        let visibility = 0.5 / (light.y * lambda(view.y) + view.y * lambda(light.y));
        let cos_half = half.dot(view).acos();
        let lobe = 0.8 * fresnel(0.04, cos_half) * distribution * visibility;
        let below = 1.0 - 0.8 * fresnel(0.04, angle);
        let expected = 100.0 * light.y * (below * 0.6 / PI + lobe);
        let [r, ..] = picture.hdr[at];
        println!("{angle}: {r}, of {expected}");
        // For half floats, normals of 11 bits, a strength of 8 bits, and a pixel off the centre.
        assert!((r / expected - 1.0).abs() < 0.02, "{angle}: {r}, not {expected}");
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn sheen_is_brightest_at_grazing_angles_and_conserves_energy() {
    let velvet = |albedo: f32, color: Vec3| {
        let sheen = Sheen { color, roughness: 0.4, texture: None };
        Material { sheen, ..Material::diffuse("velvet", Vec3::splat(albedo)) }
    };
    let mut last = 0.0;
    for angle in ANGLES {
        assert_near("white", under_the_sky(angle, velvet(1.0, Vec3::ONE)), Vec3::ONE, 0.01);
        let alone = under_the_sky(angle, velvet(0.0, Vec3::new(1.0, 0.5, 0.0)));
        println!("{angle}: {alone}");
        assert!((alone.y - 0.5 * alone.x).abs() < 0.01 && alone.z < 0.002, "{alone}");
        assert!(alone.x > last + 0.01, "velvet sends {} at {angle}, {last} before", alone.x);
        last = alone.x;
    }
}

#[test]
fn specular_reflection_uses_the_specular_texture() {
    let mut scene = seen_under(0.0, Material::default());
    scene.environment.radiance = Vec3::ONE;
    // sRGB codes of 1, 0.2140 and 0; a factor of 0.8.
    scene.textures.push(texture(1, 1, |_, _| [255, 128, 0, 204]));
    scene.materials[0] = metallic_roughness(MetallicRoughness {
        base_color: Vec4::W,
        roughness: 0.1,
        ior: 0.0,
        specular_color: Vec3::new(0.5, 1.0, 1.0),
        specular_texture: Some(TextureRef::new(0)),
        ..MetallicRoughness::default()
    });
    let settings = RenderSettings { bounces: 1, frames: 16, ..settings(View::Final) };
    let expected = 0.8 * Vec3::new(0.5, 0.2159, 0.0);
    assert_near("gloss", mean(&render(&scene, settings)), expected, 0.01);
}

#[test]
#[ignore = "slow: over three seconds"]
fn unlit_surfaces_are_scaled_by_reference_white() {
    let color = Vec3::new(0.5, 0.25, 1.0);
    let unlit = Shading::Unlit(Unlit { color: color.extend(1.0), color_texture: None });
    let mut scene = seen_under(0.0, Material { shading: unlit, ..Material::default() });
    scene.lights.push(Light {
        kind: LightKind::Directional,
        intensity: 100.0,
        direction: Vec3::new(0.5, -0.6, 0.0).normalize(),
        ..Light::default()
    });
    let shown = mean(&render(&scene, RenderSettings { bounces: 2, ..settings(View::Final) }));
    assert_near("unlit", shown, color * (100.0 / PI), 0.01 * 100.0 / PI);
    // An unlit surface does not emit light, and reflects diffusely: the wall beside it receives
    // only the sun's light that the floor reflects.
    let wall = quad(Vec3::new(-1.0, 1.0, 0.0), -Vec3::Z * 2.0, Vec3::Y);
    add(&mut scene, wall, Material::diffuse("wall", Vec3::ONE));
    scene.cameras = vec![Camera::look_at(Vec3::new(1.0, 0.5, 0.0), Vec3::new(-1.0, 0.5, 0.0), 0.2)];
    let lit = |scene: &Scene| {
        let settings = RenderSettings { bounces: 2, resolution: 64, ..settings(View::Diffuse) };
        mean(&render(scene, settings))
    };
    let beside = lit(&scene);
    scene.materials[0] = Material::diffuse("matte", color);
    let expected = lit(&scene);
    assert!(expected.min_element() > 0.5, "{expected}");
    assert_near("beside", beside, expected, 1e-4 * expected.max_element());
    scene.materials[0] = Material { shading: unlit, ..Material::default() };
    scene.lights.clear();
    scene.environment.radiance = Vec3::ZERO;
    scene.materials[1].emissive = Vec3::splat(1e-9);
    assert_near("without light", lit(&scene), Vec3::ZERO, 1e-6);
}
