//! Notes on what is too coarse for what is seen.

use std::cell::OnceCell;

use super::*;
use crate::Light;

/// The subjects of the notes for a scene without other light.
fn subjects(scene: &Scene, fineness: Fineness) -> Vec<&'static str> {
    let staging = Staging::None;
    let options = SightOptions { staging, fineness, ..SightOptions::default() };
    let framing = OnceCell::from(Framing::of(scene));
    Sight::of(scene, &options, &framing).notes.iter().map(|note| note.about).collect()
}

#[test]
fn large_voxels_give_a_note_about_the_grid() {
    let scene = builtin::scene("cornell").unwrap();
    // The box is 2 m wide.
    for (voxel_m, is_coarse) in [(1.0 / 64.0, false), (1.0 / 16.0, false), (0.5, true)] {
        let fineness = Fineness { voxel_m: Some(voxel_m), shadow_maps: None };
        assert_eq!(subjects(&scene, fineness).contains(&"grid"), is_coarse, "{voxel_m} m");
    }
}

#[test]
fn large_shadow_texels_give_a_note() {
    // Blocks of a metre on a ground of 2 km.
    let ground = quad(Vec3::ZERO, Vec3::Z * 1000.0, Vec3::X * 1000.0);
    let block = |x: f32| {
        let min = Vec3::new(2.0 * x, 0.0, 0.0);
        cuboid(min, min + Vec3::ONE, Faces::NO_BOTTOM)
    };
    let mut scene = scene([ground, merge((-4..4).map(|x| block(x as f32)))], false);
    scene.cameras.push(Camera {
        position: Vec3::new(0.0, 4.0, 8.0),
        forward: Vec3::new(0.0, -4.0, -8.0).normalize(),
        ..Camera::default()
    });
    let direction = Vec3::new(0.3, -0.5, 0.8).normalize();
    let (sun, lamp) = ((LightKind::Directional, 1e5), (LightKind::Point, 1e9));
    let above = direction * -2000.0;
    for ((kind, intensity), squares, is_coarse) in
        [(sun, 0, true), (sun, 3, false), (lamp, 3, true)]
    {
        let light = Light { direction, position: above, kind, intensity, ..Light::default() };
        scene.lights = vec![light];
        let maps = ShadowMapFineness { resolution: 1024, squares, step: 4.0, reach_m: None };
        let fineness = Fineness { voxel_m: None, shadow_maps: Some(maps) };
        assert_eq!(
            subjects(&scene, fineness).contains(&"shadows"),
            is_coarse,
            "{kind:?}, {squares}"
        );
    }
}
