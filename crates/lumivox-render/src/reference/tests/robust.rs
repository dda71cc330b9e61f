//! Tests that numerically difficult scenes leave no pixel undefined.

use lumivox_scene::{AlphaMode, Filter, Shading};

use super::*;
use crate::RenderError;

#[test]
fn a_fully_transparent_scene_shows_its_surroundings() {
    let mut scene = stage();
    scene.environment.radiance = Vec3::new(0.25, 0.5, 2.0);
    let mut gone = Material::diffuse("gone", Vec3::ONE);
    gone.alpha = AlphaMode::Blend;
    if let Shading::MetallicRoughness(shading) = &mut gone.shading {
        shading.base_color.w = 0.0;
    }
    add(&mut scene, pane(0.0), gone);
    let layers = traced(&scene, &settings(4, 4));
    assert!(layers.radiance.iter().all(|pixel| *pixel == [0.25, 0.5, 2.0]));
    assert!(layers.coverage.iter().chain(&layers.occlusion).all(|share| *share == 0.0));
}

/// Outside a spot light's cone and beyond a lamp's range, sampled directions hit discs that send no
/// light.
#[test]
fn round_lamps_out_of_reach_add_no_light() {
    let mut scene = stage();
    scene.environment.radiance = Vec3::splat(0.5);
    add(&mut scene, pane(0.0), Material::diffuse("wall", Vec3::ONE));
    let away = Light {
        kind: LightKind::Spot,
        inner_angle_rad: 0.1,
        outer_angle_rad: 0.2,
        direction: Vec3::Z,
        ..point_light(Vec3::Z, 5.0, 0.5)
    };
    let near = Light { range_m: Some(0.5), ..point_light(Vec3::Z, 5.0, 0.4) };
    for light in [away, near, point_light(Vec3::Z, 0.0, 0.5), sun(Vec3::NEG_Z, 0.0, 0.3)] {
        scene.lights = vec![light];
        let layers = traced(&scene, &settings(4, 16));
        assert!(layers.direct.iter().all(|pixel| *pixel == [0.0; 3]), "{:?}", layers.direct);
        Estimate::radiance(&layers).assert_is("under the sky", 0.5);
    }
}

/// Points inside a lamp, at its centre, and with undefined normals and tangents.
#[test]
fn degenerate_normals_and_lamp_centres_stay_finite() {
    let mut scene = stage();
    scene.environment.radiance = Vec3::ONE;
    let mut opposed = pane(0.0);
    // Interpolated normals cancel out along a line of the picture; the tangents are parallel to
    // them.
    opposed.normals = vec![Vec3::Y, Vec3::NEG_Y, Vec3::Y, Vec3::NEG_Y];
    opposed.tangents = vec![Vec3::Y.extend(1.0); 4];
    let mut material = Material::diffuse("wall", Vec3::splat(0.5));
    let flat = vec![128, 128, 255, 255];
    let flat = texture(&mut scene, UVec2::ONE, Filter::Linear, flat);
    material.normal_texture = Some(flat);
    add(&mut scene, opposed, material);
    scene.lights = vec![point_light(Vec3::ZERO, 1.0, 0.3), point_light(Vec3::Z * 0.1, 1.0, 0.0)];
    let layers = traced(&scene, &settings(9, 16));
    assert!(layers.coverage.iter().all(|share| *share == 1.0));
    // Needles without a normal do not exist.
    let mut scene = stage();
    scene.environment.radiance = Vec3::ONE;
    let mut needles = pane(0.0);
    needles.positions = vec![
        Vec3::new(-1.0, -1.0, 0.0),
        Vec3::new(1.0, 1.0, 0.0),
        Vec3::new(0.3, 0.3 + 1e-7, 0.0),
        Vec3::new(-0.3, -0.3, 1e-8),
    ];
    add(
        &mut scene,
        needles,
        Material { double_sided: true, ..Material::diffuse("needle", Vec3::ONE) },
    );
    let layers = traced(&scene, &settings(9, 16));
    assert!(layers.radiance.iter().all(|pixel| *pixel == [1.0; 3]), "{:?}", layers.radiance);
}

#[test]
fn scenes_beyond_device_limits_are_refused_before_tracing() {
    let mut scene = stage();
    let mut mesh = pane(0.0);
    mesh.indices = [0, 1, 2].repeat(2000);
    add(&mut scene, mesh, Material::diffuse("many", Vec3::ONE));
    scene.instances = vec![scene.instances[0].clone(); 3000];
    let gpu = gpu();
    let made = PathTracer::new(&gpu, &scene, None, settings(4, 4));
    let error = pollster::block_on(made).expect_err("six million triangles are too many");
    let RenderError::Limit { needed, available, .. } = error else { panic!("{error}") };
    assert!(needed > available, "{needed} of {available} bytes");
}
