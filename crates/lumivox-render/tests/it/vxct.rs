//! The look of VXCT, held to closed forms: Phong's light, shadows that do not depend on the voxels, emission that
//! lights.

mod light;

use std::f32::consts::PI;

use glam::{UVec2, Vec2, Vec3};
use lumivox::{Directionality, OctreeOptions, VolumeKind};
use lumivox_render::gbuffer_pass::clip_from_world;
use lumivox_render::{
    Components, Exposure, Gpu, Injected, Look, Picture, RenderSettings, Renderer, ToneMap, View,
    VxctSettings, vxct_display,
};
use lumivox_scene::{
    Attenuation, Bounds, Camera, Instance, Light, LightKind, Material, Mesh, Phong, Scene, Shading,
};

use crate::common::{builtin, gpu, mean_luminance, picture, renderer};

const SIZE: UVec2 = UVec2::new(48, 36);

/// The cube that VXCT's scenes are in.
const CUBE: Bounds = Bounds { min: Vec3::NEG_ONE, max: Vec3::ONE };

fn look(vxct: VxctSettings) -> RenderSettings {
    RenderSettings {
        size: SIZE,
        resolution: 64,
        grid_bounds: Some(CUBE),
        directionality: Directionality::Isotropic,
        bounces: 1,
        frames: 1,
        exposure: Exposure::Stops(0.0),
        tone_map: ToneMap::Raw,
        look: Look::Vxct(vxct),
        ..RenderSettings::default()
    }
}

/// Those of 64 voxels.
fn usual() -> VxctSettings {
    VxctSettings::for_resolution(64)
}

/// Only what Phong's formula has.
fn phong_alone() -> VxctSettings {
    VxctSettings { diffuse: false, specular: false, shadows: false, ..usual() }
}

/// A material as VXCT's files have them, with a diffuse strength of 1.
fn vxct_material(color: Vec3, shininess: f32, specular_strength: f32) -> Material {
    Material {
        name: "vxct".to_owned(),
        shading: Shading::Phong(Phong {
            diffuse: color,
            specular: Vec3::splat(2.0 * specular_strength / (shininess + 2.0)),
            shininess,
            ambient: 0.08,
            ..Phong::default()
        }),
        double_sided: true,
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
        kind: LightKind::Point { intensity_cd: PI / at_one_metre, range_m: None },
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
fn a_surface_under_a_light_is_phongs() {
    let color = Vec3::new(0.5, 0.4, 0.3);
    let light_color = Vec3::new(0.9, 0.8, 0.7);
    let light = Vec3::new(0.3, 1.1, -0.9);
    let scene = floor(0.0, vxct_material(color, 32.0, 0.5), vxct_light(light, light_color));
    let camera = &scene.cameras[0];
    let world_from_clip = clip_from_world(camera, SIZE, Vec2::ZERO).inverse();
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
        let highlight = 0.5 * mirrored.dot(v).max(0.0).powf(32.0);
        brightest = brightest.max(highlight);
        let expected = (color * (0.08 + l.y) + highlight) * light_color * fading;
        let error = (rgb(&shown, pixel) - expected).abs().max_element();
        // The G-buffer has 8 bits for colours, the highlight's strength and its exponent: 1 % of the colour, and up to
        // 8 % of a highlight.
        let tolerance = 0.01 * expected.max_element() + 0.08 * highlight;
        assert!(error < tolerance, "{pixel}: {} is not {expected}", rgb(&shown, pixel));
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
    assert!((sum - whole).abs().max_element() < 1e-5, "{missing:?} are not {whole}");
    assert_eq!(without(|s| s.phong = false), Vec3::ZERO);
}

#[test]
fn lamps_of_other_scenes_fade_as_vxcts() {
    // 5 cd, 2 m above a white floor of 8 m: a unit is 4 m, and the lamp half of it away.
    let mut scene = Scene { name: "hall".to_owned(), ..Scene::default() };
    add_square(&mut scene, Vec3::ZERO, UP, 4.0, Material::diffuse("white", Vec3::ONE));
    scene.lights.push(Light {
        kind: LightKind::Point { intensity_cd: 5.0, range_m: None },
        position: Vec3::new(0.0, 2.0, 0.0),
        ..Light::default()
    });
    scene.cameras.push(Camera::look_at(Vec3::Y, Vec3::ZERO, 0.2));
    let settings = RenderSettings { grid_bounds: None, ..look(phong_alone()) };
    let shown = middle(&render(&scene, settings)).x;
    let color = 5.0 / PI * 1.6 / 16.0;
    let expected = color / (1.0 + 0.15 * 0.5 + 0.45 * 0.25);
    assert!((shown / expected - 1.0).abs() < 0.01, "{shown} is not {expected}");
    let display = vxct_display(&scene);
    assert!((display.white / color - 1.0).abs() < 1e-5, "{display:?}");
    assert_eq!(display.tone_map, ToneMap::Linear);
}

#[test]
fn display_values_reach_the_screen_as_they_are() {
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

/// A floor with a lamp 1.5 above it, and a plate at a height between them; seen from beside and below the plate.
fn plate(height: f32, half: f32) -> Scene {
    let mut scene = floor(-1.0, matte(), vxct_light(Vec3::new(0.0, 0.5, 0.0), Vec3::ONE));
    if half > 0.0 {
        add_square(&mut scene, Vec3::new(0.0, height - 1.0, 0.0), UP, half, matte());
    }
    let eye = Vec3::new(0.0, 0.8 * height - 1.0, 0.9);
    scene.cameras = vec![Camera::look_at(eye, Vec3::NEG_Y, 0.2)];
    scene
}

/// The share of the light that arrives in the middle of its floor.
fn visible_below(scene: &Scene, resolution: u32, shadow_strength: f32) -> f32 {
    let vxct = VxctSettings { shadow_strength, ..usual() };
    let settings = RenderSettings { view: View::Shadow, resolution, ..look(vxct) };
    middle(&render(scene, settings)).x
}

#[test]
fn an_opaque_wall_hides_the_light() {
    for resolution in [64, 128] {
        // The plate is 1 above the floor, the lamp 1.5: smoothstep(0, 1.5, 1.5 sqrt(1)) is one.
        let hidden = visible_below(&plate(1.0, 0.8), resolution, 1.5);
        assert!(hidden < 0.01, "{resolution}: {hidden} of the light passes the plate");
        let seen = visible_below(&plate(1.0, 0.0), resolution, 1.5);
        assert!((seen - 1.0).abs() < 1e-6, "{resolution}: {seen} of the light arrives");
    }
}

#[test]
fn shadows_are_softer_near_what_casts_them() {
    // At d = 0.25 of D = 1.5, smoothstep(0, 1.5, strength sqrt(0.25)) is 0, 0.07, 0.5 and 1.
    for resolution in [64, 128] {
        let visible = [0.0, 0.5, 1.5, 3.0].map(|s| visible_below(&plate(0.25, 0.6), resolution, s));
        println!("{resolution}: {visible:.3?}");
        // A closed wall counts once, or up to 1.25 / (1 - 0.4 / 2) times: cells grow by 0.4 a length (cone.wgsl). It is
        // felt over a cell before and behind it, which moves d by up to a half.
        assert!((visible[0] - 1.0).abs() < 1e-6, "{visible:?}");
        assert!((0.80..0.97).contains(&visible[1]), "{visible:?}");
        assert!((0.10..0.55).contains(&visible[2]), "{visible:?}");
        assert!(visible[3] < 0.05, "{visible:?}");
    }
}

/// The Cornell box in the look, as the mean of a view over its pixels.
fn mean_of_cornell(view: View, resolution: u32, vxct: VxctSettings) -> f64 {
    let settings = RenderSettings { view, resolution, grid_bounds: None, ..look(vxct) };
    mean_luminance(&render(&builtin("cornell"), settings))
}

/// A room with a lamp and a plate beside it, below which the floor lies in the shadow.
fn furnished_room() -> Scene {
    let material = vxct_material(Vec3::new(0.8, 0.6, 0.4), 32.0, 0.5);
    let mut scene = room(&material, vxct_light(Vec3::new(0.1, 0.55, 0.0), Vec3::ONE));
    add_square(&mut scene, Vec3::new(-0.3, -0.3, -0.2), UP, 0.35, material);
    scene.cameras =
        vec![Camera::look_at(Vec3::new(0.2, 0.4, 0.9), Vec3::new(-0.1, -0.6, -0.4), 1.3)];
    scene
}

#[test]
fn brightness_does_not_depend_on_the_resolution() {
    let scene = furnished_room();
    let vxct = VxctSettings::for_resolution(128);
    for view in [View::Shadow, View::Diffuse, View::Specular, View::Final] {
        let means = [64, 128, 256].map(|resolution| {
            mean_luminance(&render(&scene, RenderSettings { view, resolution, ..look(vxct) }))
        });
        println!("{view:?}: {means:.4?}");
        for mean in means {
            // Walls are a voxel thick, and edges as sharp as the voxels.
            assert!((mean / means[1] - 1.0).abs() < 0.05, "{view:?}: {means:?}");
        }
    }
}

#[test]
fn brightness_does_not_depend_on_the_distance_factor() {
    for view in [View::Shadow, View::Indirect] {
        let means = [0.01, 0.1, 0.35, 0.8].map(|factor| {
            let mut vxct = usual();
            vxct.diffuse_cone.distance_factor = factor;
            vxct.occlusion_cone.distance_factor = factor;
            vxct.specular_cone.distance_factor = factor;
            mean_of_cornell(view, 64, vxct)
        });
        println!("{view:?}: {means:.4?}");
        for mean in means {
            assert!((mean / means[0] - 1.0).abs() < 0.02, "{view:?}: {means:?}");
        }
    }
}

#[test]
fn every_normal_has_side_cones() {
    let material = vxct_material(Vec3::splat(0.7), 32.0, 0.5);
    let scene = room(&material, vxct_light(Vec3::ZERO, Vec3::ONE));
    let vxct = VxctSettings { side_cones: true, ..usual() };
    let mut renderer =
        renderer(&gpu(), &scene, RenderSettings { view: View::Diffuse, ..look(vxct) });
    let mut walls = Vec::new();
    for axis in [Vec3::X, Vec3::Y, Vec3::Z, Vec3::NEG_X, Vec3::NEG_Y, Vec3::NEG_Z] {
        renderer.set_camera(Camera::look_at(Vec3::ZERO, axis, 0.9));
        let shown = picture(&mut renderer);
        assert!(shown.hdr.iter().flatten().all(|value| value.is_finite()), "{axis}");
        walls.push(mean_luminance(&shown));
    }
    // All walls are alike; the camera turns its long side another way on floor and ceiling.
    println!("{walls:.4?}");
    assert!(walls.iter().all(|wall| (wall / walls[0] - 1.0).abs() < 0.01), "{walls:?}");
    assert!(walls[0] > 0.1, "{walls:?}");
}

#[test]
fn what_emits_lights_the_scene() {
    let mut scene = floor(-1.0, matte(), vxct_light(Vec3::ZERO, Vec3::ZERO));
    let glow = Vec3::new(1.0, 0.5, 0.25);
    let panel = Material { emissive: glow, ..Material::diffuse("panel", Vec3::ZERO) };
    add_square(&mut scene, Vec3::new(0.0, 0.9, 0.0), (Vec3::X, Vec3::NEG_Y), 1.0, panel);
    scene.cameras = vec![Camera::look_at(Vec3::new(0.0, 0.0, 0.9), Vec3::NEG_Y, 0.3)];
    let lit = middle(&render(&scene, look(usual())));
    // The front cone sees the panel alone; of the others at least a part of it, or nothing.
    let most = 0.8 * glow;
    assert!(lit.cmpge(0.19 * most).all() && lit.cmple(1.01 * most).all(), "{lit}");
    assert!((lit / lit.x - glow).abs().max_element() < 0.02, "{lit}");

    scene.materials[1].emissive = Vec3::ZERO;
    assert_eq!(middle(&render(&scene, look(usual()))), Vec3::ZERO);
}

#[test]
fn the_components_add_up() {
    let material = vxct_material(Vec3::new(0.7, 0.5, 0.3), 32.0, 0.5);
    let scene = room(&material, vxct_light(Vec3::new(0.2, 0.5, -0.3), Vec3::ONE));
    let mut renderer = renderer(&gpu(), &scene, look(usual()));
    let mut of = |components| {
        let vxct = VxctSettings { components, ..usual() };
        renderer.set_look(Look::Vxct(vxct)).expect("a valid look");
        picture(&mut renderer)
    };
    let whole = of(Components::All);
    let parts = [Components::Phong, Components::Specular, Components::Diffuse].map(&mut of);
    for part in &parts {
        assert!(mean_luminance(part) > 0.01);
    }
    for (pixel, all) in whole.hdr.iter().enumerate() {
        for (channel, all) in all.iter().enumerate().take(3) {
            let sum: f32 = parts.iter().map(|part| part.hdr[pixel][channel]).sum();
            assert!((sum - all).abs() < 1e-5 * all.max(1.0), "{pixel}: {sum}, not {all}");
        }
    }
    // And shadows are grey, from 0 to 1.
    let shadows = of(Components::Shadows);
    assert!(shadows.hdr.iter().all(|p| p[0].to_bits() == p[2].to_bits() && p[0] <= 1.0 + 1e-6));
}

/// The radiance of all faces, in the GPU's unit.
fn face_radiance(renderer: &Renderer, gpu: &Gpu) -> Vec<[f32; 4]> {
    let buffer = renderer.gi().face_radiance().expect("faces");
    let read = lumivox::gpu::read_buffer(&gpu.device, &gpu.queue, buffer, 0..buffer.size());
    pollster::block_on(read).expect("a read-back")
}

#[test]
fn the_voxels_hold_the_light_that_is_asked_for() {
    let gpu = gpu();
    let color = Vec3::new(0.5, 0.4, 0.3);
    // Right above the floor's middle, far away: n l is nearly 1 all over it. Physically a highlight is light, too.
    let brightest = |light_color: f32, injected_light| {
        let specular = if injected_light == Injected::Vxct { 0.5 } else { 0.0 };
        let light = vxct_light(Vec3::new(0.0, 99.0, 0.0), Vec3::splat(light_color));
        let scene = floor(-1.0, vxct_material(color, 32.0, specular), light);
        let mut renderer = renderer(&gpu, &scene, look(usual()));
        let was = face_radiance(&renderer, &gpu);
        let vxct = VxctSettings { injected_light, ..usual() };
        renderer.set_look(Look::Vxct(vxct)).expect("a valid look");
        let is = face_radiance(&renderer, &gpu);
        assert_eq!(was == is, injected_light == Injected::Vxct);
        // The renderer's unit is that of the cube that the grid is fitted to; light and back cancel.
        let largest = |channel: usize| is.iter().map(|face| face[channel]).fold(0.0, f32::max);
        Vec3::new(largest(0), largest(1), largest(2))
    };
    // At most white, which tells what 1 is on the GPU.
    let white = brightest(5.0, Injected::Vxct);
    assert!((white / white.x - Vec3::ONE).abs().max_element() < 1e-6, "{white}");
    // (ambient + n l) times colour, however far the light is. The unit follows the light's strength by powers of two.
    let unattenuated = brightest(0.7, Injected::Vxct) / white.x;
    let expected = color * 0.7 * 1.08;
    let powers = (unattenuated / expected).x.log2().round().exp2();
    let error = (unattenuated / powers - expected).abs().max_element();
    assert!(error < 0.01 * expected.x, "{unattenuated} is not {expected}");
    // By the inverse square, 100 m away, and without ambient light.
    let physical = brightest(0.7, Injected::Shadowed) / white.x / powers;
    let expected = color * 0.7 / 1.6 / 1e4;
    let error = (physical - expected).abs().max_element();
    assert!(error < 0.02 * expected.x, "{physical} is not {expected}");
}

#[test]
fn both_volumes_show_the_same() {
    let mean = |volume| {
        let settings = RenderSettings { volume, grid_bounds: None, ..look(usual()) };
        mean_luminance(&render(&builtin("cornell"), settings))
    };
    let dense = mean(VolumeKind::Dense);
    let octree = mean(VolumeKind::Octree(OctreeOptions::default()));
    // Half floats are rounded level by level in another order (ARCHITECTURE.md).
    assert!((octree / dense - 1.0).abs() < 0.005, "{octree} is not {dense}");
}

#[test]
fn two_runs_give_the_same_bits() {
    let run = || {
        let settings = RenderSettings { frames: 3, grid_bounds: None, ..look(usual()) };
        render(&builtin("cornell"), settings)
    };
    let (first, second) = (run(), run());
    let bits = |picture: &Picture| -> Vec<u32> {
        picture.hdr.iter().flatten().map(|value| value.to_bits()).collect()
    };
    assert!(bits(&first) == bits(&second));
}

#[test]
fn every_view_has_a_meaning() {
    let settings = RenderSettings { grid_bounds: None, ..look(usual()) };
    let mut renderer = renderer(&gpu(), &builtin("spheres"), settings);
    for view in View::ALL.into_iter().filter(|view| !view.needs_octree()) {
        renderer.set_view(view, 0).expect("a view");
        let shown = picture(&mut renderer);
        assert!(shown.hdr.iter().flatten().all(|value| value.is_finite()), "{view:?}");
        let has_any = shown.hdr.iter().any(|pixel| pixel[0] > 0.0);
        assert!(has_any, "{view:?} is black");
    }
}
