//! The look of VXCT compared with its own pictures, and with closed forms for scenes that it was
//! not made for.

mod changes;
#[allow(dead_code, unused_imports)] // The renderer's own tests use the rest.
#[path = "../../../../crates/lumivox-render/tests/it/common/mod.rs"]
mod common;
mod pictures;

use std::f32::consts::PI;
use std::sync::Arc;

use glam::{UVec2, Vec2, Vec3};
use lumivox_render::{Exposure, Picture, RenderSettings, ToneMap, View, clip_from_world};
use lumivox_scene::{
    Attenuation, Bounds, Camera, Instance, Light, LightKind, Material, Mesh, Scene, Shading,
    Strengths,
};
use lumivox_vxct::{VxctSettings, vxct_display};

use crate::common::{builtin, gpu, picture, renderer};

const SIZE: UVec2 = UVec2::new(48, 36);

/// The cube of VXCT's scenes.
const CUBE: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

fn look(vxct: VxctSettings) -> RenderSettings {
    RenderSettings {
        size: SIZE,
        resolution: 64,
        grid_bounds: Some(CUBE),
        frames: 1,
        exposure: Exposure::Stops(0.0),
        tone_map: ToneMap::Raw,
        look: Some(Arc::new(vxct)),
        ..RenderSettings::default()
    }
}

/// The settings for 64 voxels.
fn usual() -> VxctSettings {
    VxctSettings::for_resolution(64)
}

/// Only the terms of Phong's formula.
fn phong_alone() -> VxctSettings {
    VxctSettings { diffuse: false, specular: false, shadows: false, ..usual() }
}

/// A material as VXCT's files have them, with a diffuse strength of 1.
fn vxct_material(color: Vec3, shininess: f32, specular: f32) -> Material {
    let strengths = Strengths { color, shininess, specular, ..Strengths::default() };
    Material {
        name: "vxct".to_owned(),
        shading: Shading::Phong(strengths.to_phong()),
        double_sided: true,
        strengths: Some(strengths),
        ..Material::default()
    }
}

/// White, without highlights.
fn matte() -> Material {
    vxct_material(Vec3::splat(0.8), 32.0, 0.0)
}

/// A light of a colour with VXCT's default attenuation.
fn vxct_light(position: Vec3, color: Vec3) -> Light {
    let attenuation = Attenuation::default();
    let at_one_metre = attenuation.constant + attenuation.linear + attenuation.quadratic;
    Light {
        intensity: PI / at_one_metre,
        color,
        position,
        attenuation: Some(attenuation),
        ..Light::default()
    }
}

/// Adds a square around a point; `right` and `normal` are unit vectors.
fn add_square(scene: &mut Scene, center: Vec3, axes: (Vec3, Vec3), half: f32, material: Material) {
    let (right, normal) = axes;
    let up = normal.cross(right);
    let corners = [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)];
    scene.meshes.push(Mesh {
        name: "square".to_owned(),
        positions: corners.map(|(x, y)| center + half * (x * right + y * up)).to_vec(),
        normals: vec![normal; 4],
        uvs: vec![Vec2::ZERO; 4],
        tangents: vec![right.extend(1.0); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    });
    scene.materials.push(material);
    scene.instances.push(Instance {
        name: format!("square {}", scene.instances.len()),
        mesh: scene.meshes.len() - 1,
        material: scene.materials.len() - 1,
        ..Instance::default()
    });
}

const UP: (Vec3, Vec3) = (Vec3::X, Vec3::Y);

/// A floor of 2 x 2 at a height, a light, a camera that looks down at it from the side.
fn floor(height: f32, material: Material, light: Light) -> Scene {
    let mut scene = Scene { name: "floor".to_owned(), ..Scene::default() };
    add_square(&mut scene, Vec3::new(0.0, height, 0.0), UP, 1.0, material);
    scene.lights.push(light);
    let target = Vec3::new(0.0, height, 0.0);
    scene.cameras.push(Camera::look_at(target + Vec3::new(0.0, 1.6, 1.2), target, 0.6));
    scene
}

/// The closed cube from inside, with a light.
fn room(material: &Material, light: Light) -> Scene {
    let mut scene = Scene { name: "room".to_owned(), ..Scene::default() };
    for axis in [Vec3::X, Vec3::Y, Vec3::Z] {
        let right = Vec3::new(axis.z, axis.x, axis.y);
        for sign in [-1.0, 1.0] {
            add_square(&mut scene, sign * axis, (right, -sign * axis), 1.0, material.clone());
        }
    }
    scene.lights.push(light);
    scene.cameras.push(Camera::look_at(Vec3::ZERO, Vec3::NEG_Z, 1.2));
    scene
}

fn render(scene: &Scene, settings: RenderSettings) -> Picture {
    picture(&mut renderer(&gpu(), scene, settings))
}

fn rgb(picture: &Picture, pixel: UVec2) -> Vec3 {
    let [r, g, b, surface] = picture.hdr[(pixel.y * picture.size.x + pixel.x) as usize];
    assert!(surface >= 1.0, "{pixel} shows no surface");
    Vec3::new(r, g, b)
}

fn middle(picture: &Picture) -> Vec3 {
    rgb(picture, picture.size / 2)
}

#[test]
fn a_lit_surface_follows_the_phong_formula() {
    let color = Vec3::new(0.5, 0.4, 0.3);
    let light_color = Vec3::new(0.9, 0.8, 0.7);
    let light = Vec3::new(0.3, 1.1, -0.9);
    let scene = floor(0.0, vxct_material(color, 32.0, 3.0), vxct_light(light, light_color));
    let camera = &scene.cameras[0];
    let world_from_clip = clip_from_world(camera, SIZE).inverse();
    let at = |pixel: UVec2| {
        let ndc = 2.0 * (pixel.as_vec2() + 0.5) / SIZE.as_vec2() - 1.0;
        let through = world_from_clip.project_point3(Vec3::new(ndc.x, -ndc.y, 0.5));
        let ray = (through - camera.position).normalize();
        camera.position - ray * (camera.position.y / ray.y)
    };
    let settings = VxctSettings { phong_specular: true, ..phong_alone() };
    let shown = render(&scene, look(settings));
    let mut brightest: f32 = 0.0;
    for pixel in [UVec2::new(24, 18), UVec2::new(28, 14), UVec2::new(10, 20), UVec2::new(30, 8)] {
        let point = at(pixel);
        let to_light = light - point;
        let d = to_light.length();
        let l = to_light / d;
        let v = (camera.position - point).normalize();
        let fading = 1.0 / (1.0 + 0.15 * d + 0.45 * d * d);
        let mirrored = 2.0 * l.y * Vec3::Y - l;
        let highlight = 3.0 * mirrored.dot(v).max(0.0).powf(32.0);
        brightest = brightest.max(highlight);
        let expected = color * (0.08 + l.y + highlight) * light_color * fading;
        let expected = expected.min(Vec3::ONE);
        let error = (rgb(&shown, pixel) - expected).abs().max_element();
        // Half floats, and the positions of pixels.
        assert!(error < 0.002, "{pixel}: {} is not {expected}", rgb(&shown, pixel));
    }
    assert!(brightest > 0.2, "no pixel shows the highlight: {brightest}");

    // Each term can be left out.
    let pixel = SIZE / 2;
    let without = |change: fn(&mut VxctSettings)| {
        let mut settings = settings;
        change(&mut settings);
        rgb(&render(&scene, look(settings)), pixel)
    };
    let whole = rgb(&shown, pixel);
    let missing = [
        whole - without(|s| s.phong_ambient = false),
        whole - without(|s| s.phong_diffuse = false),
        whole - without(|s| s.phong_specular = false),
    ];
    let sum: Vec3 = missing.iter().sum();
    assert!((sum - whole).abs().max_element() < 2e-3, "{missing:?} are not {whole}");
    assert_eq!(without(|s| s.phong = false), Vec3::ZERO);
    // Without indirect light all terms are shown, regardless of the switches.
    let plain = without(|s| *s = VxctSettings { indirect_light: false, phong: false, ..*s });
    assert!((plain - whole).abs().max_element() < 1e-6, "{plain} is not {whole}");
}

#[test]
fn lamps_of_other_scenes_use_vxct_attenuation() {
    // 5 cd, 2 m above a white floor of 8 m: a unit is 4 m, so the lamp is half a unit away.
    let mut scene = Scene { name: "hall".to_owned(), ..Scene::default() };
    add_square(&mut scene, Vec3::ZERO, UP, 4.0, Material::diffuse("white", Vec3::ONE));
    scene.lights.push(Light {
        intensity: 5.0,
        position: Vec3::new(0.0, 2.0, 0.0),
        ..Light::default()
    });
    scene.cameras.push(Camera::look_at(Vec3::Y, Vec3::ZERO, 0.2));
    let settings = RenderSettings { grid_bounds: None, ..look(phong_alone()) };
    let shown = middle(&render(&scene, settings)).x;
    let color = 5.0 / PI * 1.6 / 16.0;
    // Materials of other scenes have VXCT's ambient strength.
    let expected = 1.08 * color / (1.0 + 0.15 * 0.5 + 0.45 * 0.25);
    assert!((shown / expected - 1.0).abs() < 0.01, "{shown} is not {expected}");
    let display = vxct_display(&scene);
    assert!((display.white / color - 1.0).abs() < 1e-5, "{display:?}");
    assert_eq!(display.tone_map, ToneMap::Linear);
}

#[test]
fn display_values_are_not_tone_mapped() {
    let light = vxct_light(Vec3::Y, Vec3::ONE);
    let scene = floor(0.0, vxct_material(Vec3::new(0.5, 0.4, 0.3), 32.0, 0.5), light);
    let shown = render(&scene, look(phong_alone()));
    for (hdr, ldr) in shown.hdr.iter().zip(&shown.ldr) {
        for (value, code) in hdr.iter().zip(ldr).take(3) {
            let expected = 255.0 * value.clamp(0.0, 1.0);
            assert!((expected - f32::from(*code)).abs() < 0.6, "{hdr:?} became {ldr:?}");
        }
    }
    let display = vxct_display(&scene);
    assert_eq!((display.exposure, display.tone_map), (Exposure::Stops(0.0), ToneMap::Raw));
}

/// Only surfaces that face the camera are drawn, even if the physical look shows both sides; a
/// mirroring matrix shows the inside.
#[test]
fn only_front_faces_are_drawn() {
    let mut scene = floor(0.0, matte(), vxct_light(Vec3::Y, Vec3::ONE));
    let seen = |scene: &Scene| {
        let shown = render(scene, look(phong_alone()));
        let [.., alpha] = shown.hdr[(SIZE.y / 2 * SIZE.x + SIZE.x / 2) as usize];
        alpha > 0.0
    };
    assert!(seen(&scene));
    let from_below = Camera::look_at(Vec3::new(0.0, -1.6, 1.2), Vec3::ZERO, 0.6);
    let from_above = std::mem::replace(&mut scene.cameras[0], from_below);
    assert!(!seen(&scene));
    // The background is a dark grey, everywhere: 25.5, which GPUs round up or down.
    let shown = render(&scene, look(phong_alone()));
    let is_grey = |pixel: &[u8; 4]| [[25; 3], [26; 3]].contains(&[pixel[0], pixel[1], pixel[2]]);
    assert!(shown.ldr.iter().all(is_grey), "{:?}", shown.ldr[0]);

    let mirror = glam::Mat4::from_scale(Vec3::new(-1.0, 1.0, 1.0));
    scene.instances[0].world_from_local = mirror;
    // Loaders reverse the winding of mirrored meshes, so that fronts stay fronts.
    scene.meshes[0].indices = vec![0, 2, 1, 0, 3, 2];
    assert!(seen(&scene));
    scene.cameras = vec![from_above];
    assert!(!seen(&scene));
}

#[test]
fn suns_light_with_their_own_irradiance() {
    let sun = Light {
        kind: LightKind::Directional,
        intensity: 3.0,
        direction: Vec3::new(0.6, -0.8, 0.0),
        position: Vec3::splat(7.0),
        ..Light::default()
    };
    let shown = render(&floor(0.0, matte(), sun), look(phong_alone()));
    let expected = 0.8 * (0.08 + 0.8) * 3.0 / PI;
    for pixel in [UVec2::new(24, 18), UVec2::new(14, 12), UVec2::new(34, 26)] {
        let lit = rgb(&shown, pixel).x;
        assert!((lit / expected - 1.0).abs() < 0.01, "{pixel}: {lit} is not {expected}");
    }
}

/// In a scene that was not made for VXCT, emitters are in the voxels; if only its surroundings
/// light it, it is not black.
#[test]
fn scenes_not_made_for_vxct_are_lit() {
    let mut scene = floor(-1.0, Material::diffuse("white", Vec3::ONE), Light::default());
    scene.lights.clear();
    let panel = Material { emissive: Vec3::ONE, ..Material::diffuse("panel", Vec3::ZERO) };
    add_square(&mut scene, Vec3::new(0.0, -0.3, 0.0), (Vec3::X, Vec3::NEG_Y), 1.0, panel);
    scene.cameras =
        vec![Camera::look_at(Vec3::new(0.0, -0.9, 0.1), Vec3::new(0.0, -0.3, 0.0), 0.3)];
    let held = middle(&render(&scene, RenderSettings { view: View::Lod, ..look(usual()) })).x;
    let white = vxct_display(&scene).white;
    assert!(held > 0.5 * white && held <= white, "{held} of {white}");

    let mut outdoors = floor(0.0, Material::diffuse("white", Vec3::ONE), Light::default());
    outdoors.lights.clear();
    outdoors.environment.radiance = Vec3::splat(1000.0);
    let white = vxct_display(&outdoors).white;
    let lit = middle(&render(&outdoors, look(phong_alone()))).x / white;
    assert!((lit - 1.0).abs() < 0.1, "{lit}");
}

/// A picture of only shadows is grey: the sum over all lights of the share that is not blocked.
#[test]
fn a_shadow_only_picture_is_grey() {
    let mut scene = room(&matte(), vxct_light(Vec3::new(0.0, 0.5, 0.0), Vec3::X));
    add_square(&mut scene, Vec3::ZERO, UP, 0.5, matte());
    scene.cameras = vec![Camera::look_at(Vec3::new(0.0, -0.3, 0.95), Vec3::NEG_Y, 0.4)];
    let alone = VxctSettings { phong: false, diffuse: false, specular: false, ..usual() };
    let shown = render(&scene, look(alone));
    assert!(shown.hdr.iter().all(|p| p[0].to_bits() == p[2].to_bits()));
    let hidden = middle(&shown).x;
    let bright = middle(&render(&scene, look(VxctSettings { shadow_strength: 0.0, ..alone }))).x;
    assert!((0.1..0.7).contains(&hidden) && (bright - 1.0).abs() < 1e-6, "{hidden} and {bright}");
    scene.lights.push(scene.lights[0].clone());
    let twice = middle(&render(&scene, look(alone))).x;
    assert!((twice - (2.0 * hidden).min(1.0)).abs() < 2e-3, "{twice} is not twice {hidden}");
}

#[test]
fn every_view_renders_a_finite_picture() {
    let settings = RenderSettings { grid_bounds: None, ..look(usual()) };
    let mut renderer = renderer(&gpu(), &builtin("spheres"), settings);
    let is_shown = |view: &View| !view.needs_octree() && !view.needs_past();
    for view in View::ALL.into_iter().filter(is_shown) {
        renderer.set_view(view, 0).expect("a view");
        let shown = picture(&mut renderer);
        assert!(shown.hdr.iter().flatten().all(|value| value.is_finite()), "{view:?}");
        let has_any = shown.hdr.iter().any(|pixel| pixel[0] > 0.0);
        assert!(has_any, "{view:?} is black");
    }
}
