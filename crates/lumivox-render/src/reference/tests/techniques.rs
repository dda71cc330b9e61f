//! Tests that different techniques find the same light, and that the tracer's leave less noise.

use lumivox_scene::{EnvironmentMap, Filter, MetallicRoughness, Shading};

use super::*;

fn glossy(color: Vec3, metallic: f32, roughness: f32) -> Material {
    Material {
        shading: Shading::MetallicRoughness(MetallicRoughness {
            base_color: color.extend(1.0),
            metallic,
            roughness,
            ..MetallicRoughness::default()
        }),
        ..Material::default()
    }
}

/// A floor with gloss over paint, and a metal wall, seen obliquely from above.
fn corner() -> Scene {
    let mut scene = stage();
    let floor = quad(Vec3::ZERO, Vec3::X, Vec3::NEG_Z);
    add(&mut scene, floor, glossy(Vec3::new(0.8, 0.5, 0.3), 0.0, 0.3));
    let wall = quad(Vec3::new(0.0, 0.5, -1.0), Vec3::X, Vec3::Y * 0.5);
    add(&mut scene, wall, glossy(Vec3::splat(0.9), 1.0, 0.45));
    scene.cameras = vec![Camera::look_at(Vec3::new(0.3, 1.0, 2.2), Vec3::new(0.0, 0.2, -0.3), 0.7)];
    scene
}

/// Asserts that both find the same light, the second with less noise.
#[track_caller]
fn assert_better(what: &str, by_chance: &ReferenceLayers, asked: &ReferenceLayers, gain: f64) {
    for (layer, of) in
        [("radiance", Estimate::radiance as fn(&_) -> Estimate), ("full", Estimate::full)]
    {
        let (worse, better) = (of(by_chance), of(asked));
        better.assert_near(&format!("{what}, {layer}"), worse);
        let factor = worse.error / better.error;
        println!("{what}, {layer}: noise falls to 1 / {factor:.1}");
        assert!(factor > gain, "{what}, {layer}: noise falls to 1 / {factor} alone");
    }
}

#[test]
#[ignore = "slow: over three seconds"]
fn hit_and_sampled_emitters_give_equal_light() {
    let mut scene = corner();
    let texels = [255, 255, 255, 255, 90, 20, 200, 255];
    let halves = texture(&mut scene, UVec2::new(2, 1), Filter::Nearest, texels.to_vec());
    let mut lamp = glowing(Vec3::splat(20.0));
    lamp.emissive_texture = Some(halves);
    add(&mut scene, quad(Vec3::new(0.0, 1.2, -0.2), Vec3::X * 0.2, Vec3::Z * 0.15), lamp);
    let both = Material { double_sided: true, ..glowing(Vec3::new(0.0, 3.0, 1.0)) };
    add(&mut scene, quad(Vec3::new(0.6, 0.3, 0.0), Vec3::Z * 0.2, Vec3::Y * 0.2), both);
    let asked = traced(&scene, &settings(16, 64));
    let settings = settings(16, 256);
    let by_chance =
        tracer_with(&scene, &settings, |features| Features { has_emitters: false, ..features });
    // Even with four times the samples, chance leaves more noise.
    let by_chance = finish(by_chance);
    assert_better("emitters", &by_chance, &asked, 1.0);
    // The best of many points, as with thousands of emitters.
    let best = tracer_with(&scene, &self::settings(16, 64), |features| Features {
        candidates: 16,
        ..features
    });
    assert_better("emitters, the best of many points", &by_chance, &finish(best), 1.0);
}

#[test]
#[ignore = "slow: over three seconds"]
fn hit_and_sampled_panoramas_give_equal_light() {
    let mut scene = corner();
    let (width, height) = (32, 16);
    let mut map = EnvironmentMap { width, height, ..EnvironmentMap::default() };
    map.rgb = (0..width * height).map(|i| [0.2 + (i % 5) as f32 * 0.1, 0.3, 0.5]).collect();
    // A window above the floor.
    for (row, column) in [(3, 15), (3, 16), (4, 15), (4, 16)] {
        map.rgb[row * 32 + column] = [40.0, 30.0, 20.0];
    }
    scene.environment.map = Some(map.into());
    scene.environment.radiance = Vec3::ONE;
    scene.environment.rotation_rad = 3.0;
    let asked = traced(&scene, &settings(16, 64));
    let by_chance = tracer_with(&scene, &settings(16, 256), |features| Features {
        has_panorama: false,
        ..features
    });
    assert_better("panorama", &finish(by_chance), &asked, 1.0);
}

/// A lamp with a radius gives the light of a glowing sphere of its size and power, also in
/// reflections.
#[test]
fn a_round_lamp_equals_a_glowing_sphere() {
    let mut scene = corner();
    let (center, radiance) = (Vec3::new(0.2, 0.8, -0.2), 10.0_f32);
    let world_from_local = Mat4::from_translation(center) * Mat4::from_scale(Vec3::splat(0.5));
    let radius_m = 0.5 * zoo::RADIUS_M;
    let mesh = zoo::sphere();
    let corners = |triangle: [usize; 3]| triangle.map(|index| 0.5 * mesh.positions[index]);
    let of = |[a, b, c]: [Vec3; 3]| 0.5 * (b - a).cross(c - a).length();
    let area: f32 = mesh.triangles().map(corners).map(of).sum();
    // The mean projected area of a convex body is a quarter of its surface (Cauchy 1841).
    let intensity_cd = radiance * area / 4.0;
    // The sphere is above the picture; with one gather it does not block light from floor to wall.
    let settings = ReferenceSettings { bounces: Some(1), ..settings(24, 64) };
    // The floor's highlight is in the middle: both techniques find the lamp there.
    scene.cameras = vec![Camera::look_at(Vec3::new(0.3, 1.6, 2.2), Vec3::new(0.2, 0.0, 0.5), 0.35)];
    let mut by_mesh = scene.clone();
    add(&mut by_mesh, mesh, glowing(Vec3::splat(radiance)));
    by_mesh.instances.iter_mut().skip(2).for_each(|i| i.world_from_local = world_from_local);
    let by_mesh = traced(&by_mesh, &ReferenceSettings { bounces: Some(1), ..settings.clone() });
    scene.lights = vec![point_light(center, intensity_cd, radius_m)];
    let by_lamp = traced(&scene, &ReferenceSettings { bounces: Some(0), ..settings });
    // Corners lose a thousandth of the light.
    let mesh = Estimate::radiance(&by_mesh);
    let mesh = Estimate { error: mesh.error.hypot(2.5e-4 * mesh.mean), ..mesh };
    Estimate::radiance(&by_lamp).assert_near("a round lamp", mesh);
}

/// One bright texel lights a floor like a sun of the same irradiance in its centre.
#[test]
#[ignore = "slow: over three seconds"]
fn a_bright_texel_lights_like_a_sun() {
    let mut scene = stage();
    add(&mut scene, quad(Vec3::ZERO, Vec3::X, Vec3::NEG_Z), Material::diffuse("floor", Vec3::ONE));
    add(
        &mut scene,
        quad(Vec3::new(0.0, 0.3, 0.0), Vec3::X * 0.2, Vec3::NEG_Z * 0.2),
        glowing(Vec3::ZERO),
    );
    scene.cameras = vec![Camera::look_at(Vec3::Y * 4.0, Vec3::ZERO, 0.35)];
    let (width, height) = (64_u32, 32_u32);
    let mut map = EnvironmentMap { width, height, ..EnvironmentMap::default() };
    map.rgb = vec![[0.0; 3]; (width * height) as usize];
    let (row, column) = (9_u32, 40_u32);
    map.rgb[(row * width + column) as usize] = [500.0; 3];
    // The integral of direction times radiance over the texel.
    let mut light = glam::DVec3::ZERO;
    for part in 0..10_000_u32 {
        let inside = |part: u32| (f64::from(part) + 0.5) / 100.0;
        let polar =
            std::f64::consts::PI * (f64::from(row) + inside(part % 100)) / f64::from(height);
        let turn = std::f64::consts::TAU
            * ((f64::from(column) + inside(part / 100)) / f64::from(width) - 0.5);
        let direction =
            glam::DVec3::new(polar.sin() * turn.sin(), polar.cos(), -polar.sin() * turn.cos());
        let part_sr = std::f64::consts::PI * std::f64::consts::TAU * polar.sin()
            / f64::from(width * height)
            / 10_000.0;
        light += direction * part_sr * 500.0;
    }
    let mut by_sun = scene.clone();
    by_sun.lights = vec![sun(-light.as_vec3(), light.length() as f32, 0.05)];
    let by_sun = traced(&by_sun, &settings(24, 64));
    scene.environment.map = Some(map.into());
    scene.environment.radiance = Vec3::ONE;
    let by_map = traced(&scene, &settings(24, 256));
    let direct = |layers: &ReferenceLayers| Estimate::of(&layers.direct, &layers.direct_variance);
    // A peak of the panorama counts as a lamp. Around it the map is dark.
    direct(&by_map).assert_near("direct light", direct(&by_sun));
    Estimate::radiance(&by_map).assert_near("all light", Estimate::radiance(&by_sun));
}
