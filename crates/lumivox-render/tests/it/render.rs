//! Tests of whole renderings on a GPU or a software driver, against closed forms and CPU formulas.
//! They fail without an adapter.

#![allow(clippy::float_cmp)] // Zeros and ones that must be exact.

use std::f32::consts::PI;

use glam::{Mat4, UVec2, Vec2, Vec3};
use lumivox::{TraceSettings, VolumeKind};
use lumivox_render::{
    COST_SCALE_SAMPLES, Exposure, Picture, RenderError, RenderSettings, Renderer, ShadowMethod,
    ToneMap, View,
};
use lumivox_scene::{
    AlphaMode, Camera, Filter, Instance, Light, LightKind, Material, Mesh, Sampler, Scene, Shading,
    Texture, TextureRef, Wrap,
};

use crate::common::{gpu, own_gpu};

const SIZE: UVec2 = UVec2::new(64, 36);

fn small() -> RenderSettings {
    RenderSettings {
        size: SIZE,
        resolution: 32,
        bounces: 0,
        frames: 1,
        exposure: Exposure::Stops(0.0),
        ..RenderSettings::default()
    }
}

fn render(scene: &Scene, settings: RenderSettings) -> Result<Picture, RenderError> {
    pollster::block_on(async {
        let mut renderer = Renderer::new(&gpu(), scene, None, settings, &mut |_| {}).await?;
        renderer.render(&mut |_| {}).await
    })
}

fn center(picture: &Picture) -> [f32; 4] {
    at(picture, picture.size / 2)
}

fn at(picture: &Picture, pixel: UVec2) -> [f32; 4] {
    picture.hdr[(pixel.y * picture.size.x + pixel.x) as usize]
}

/// A square of 2 x 2 m at a height, facing up.
fn square(height_m: f32) -> Mesh {
    let corners = [(-1.0, 1.0), (1.0, 1.0), (1.0, -1.0), (-1.0, -1.0)];
    Mesh {
        name: "square".to_owned(),
        positions: corners.map(|(x, z)| Vec3::new(x, height_m, z)).to_vec(),
        normals: vec![Vec3::Y; 4],
        uvs: corners.map(|(x, z)| 0.5 + 0.5 * Vec2::new(x, z)).to_vec(),
        tangents: vec![Vec3::X.extend(1.0); 4],
        indices: vec![0, 1, 2, 0, 2, 3],
        ..Mesh::default()
    }
}

/// A white floor under a sun 60 degrees from the zenith, seen from above.
fn floor_in_the_sun() -> Scene {
    let mut scene = Scene { name: "floor".to_owned(), ..Scene::default() };
    scene.meshes.push(square(0.0));
    scene.materials.push(Material::diffuse("white", Vec3::ONE));
    scene.instances.push(Instance {
        name: "floor".to_owned(),
        mesh: 0,
        material: 0,
        world_from_local: Mat4::IDENTITY,
        ..Instance::default()
    });
    scene.lights.push(Light {
        kind: LightKind::Directional,
        intensity: 50_000.0,
        direction: Vec3::new(-(3.0_f32.sqrt()), -1.0, 0.0).normalize(),
        ..Light::default()
    });
    scene.cameras.push(Camera::look_at(Vec3::new(0.0, 3.0, 0.0), Vec3::ZERO, 0.9));
    scene
}

/// Adds a roof at 1 m, with a texture that is opaque at x < 0 and transparent at x > 0.
fn with_half_a_roof(mut scene: Scene) -> Scene {
    scene.textures.push(Texture {
        name: "half".to_owned(),
        width: 2,
        height: 1,
        rgba8: vec![255, 255, 255, 255, 255, 255, 255, 0],
        sampler: Sampler {
            wrap_u: Wrap::ClampToEdge,
            wrap_v: Wrap::ClampToEdge,
            magnify: Filter::Nearest,
            minify: Filter::Nearest,
        },
    });
    let mut material = Material::diffuse("half", Vec3::ONE);
    material.alpha = AlphaMode::Mask { cutoff: 0.5 };
    material.double_sided = true;
    if let Shading::MetallicRoughness(shading) = &mut material.shading {
        shading.base_color_texture = Some(TextureRef::new(0));
    }
    scene.meshes.push(square(1.0));
    scene.materials.push(material);
    scene.instances.push(Instance {
        name: "roof".to_owned(),
        mesh: 1,
        material: 1,
        world_from_local: Mat4::IDENTITY,
        ..Instance::default()
    });
    // With the sun at the zenith, the roof's shadow is directly below it.
    scene.lights[0].direction = Vec3::NEG_Y;
    scene
}

#[test]
fn a_lambert_floor_reflects_albedo_over_pi_of_the_illuminance() {
    for shadows in [ShadowMethod::Map, ShadowMethod::Cone] {
        let settings = RenderSettings { view: View::Direct, shadows, ..small() };
        let picture = render(&floor_in_the_sun(), settings).expect("a picture");
        let [r, _, _, surface] = center(&picture);
        let expected = 50_000.0 * 0.5 / PI;
        assert_eq!(surface, 1.0);
        // The normal's components and the result are half floats, each rounded by 0.05 %.
        assert!((r / expected - 1.0).abs() < 2e-3, "{shadows:?}: {r}, not {expected}");
    }
}

#[test]
fn data_views_show_their_physical_quantities() {
    let scene = floor_in_the_sun();
    let shown = |view| render(&scene, RenderSettings { view, ..small() }).expect("a picture");
    let normal = shown(View::Normal);
    let [x, y, z, _] = center(&normal);
    // The normals' half floats have 11 bits.
    assert!(Vec3::new(x, y - 1.0, z).length() < 2e-3, "{x} {y} {z}");
    let [r, g, b, _] = normal.ldr[(SIZE.y / 2 * SIZE.x + SIZE.x / 2) as usize];
    assert!(r.abs_diff(128) <= 1 && g >= 254 && b.abs_diff(128) <= 1, "{r} {g} {b}");
    // The pixel's centre is half a pixel off the axis, an error of a hundredth of a per cent.
    let [depth_m, ..] = center(&shown(View::Depth));
    assert!((depth_m - 3.0).abs() < 1e-3, "{depth_m}");
    let [albedo, ..] = center(&shown(View::Albedo));
    assert!((albedo - 1.0).abs() < 1e-3, "{albedo}");
    let [visibility, ..] = center(&shown(View::Shadow));
    assert_eq!(visibility, 1.0);
    // The floor ends within the picture.
    assert_eq!(at(&shown(View::Depth), UVec2::ZERO), [0.0; 4]);
}

#[test]
fn alpha_masks_cut_holes_into_pictures_and_shadows() {
    let scene = with_half_a_roof(floor_in_the_sun());
    let shown = |view| render(&scene, RenderSettings { view, ..small() }).expect("a picture");
    let (left, right) = (UVec2::new(28, 18), UVec2::new(36, 18));
    let depth = shown(View::Depth);
    // At x < 0 the roof is visible, 2 m away; at x > 0 the floor below it.
    let (near, far) = (at(&depth, left)[0], at(&depth, right)[0]);
    let (near, far) = if near < far { (near, far) } else { (far, near) };
    assert!((near - 2.0).abs() < 0.1 && (far - 3.0).abs() < 0.1, "{near} {far}");

    // Seen from below the roof, its shadow covers one half of the floor.
    let mut below = scene.clone();
    below.cameras = vec![Camera::look_at(Vec3::new(0.0, 0.9, 0.8), Vec3::ZERO, 0.9)];
    let settings = RenderSettings { view: View::Shadow, ..small() };
    let shadow = render(&below, settings).expect("a picture");
    let (left, right) = (at(&shadow, UVec2::new(16, 18))[0], at(&shadow, UVec2::new(48, 18))[0]);
    assert_eq!((left, right), (0.0, 1.0));
}

#[test]
fn display_pixels_match_the_tone_map_formulas() {
    let scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
    // A scene 1024 times as bright, exposed by 1 / 1024: it has another unit of radiance on the
    // GPU.
    let mut bright = scene.clone();
    bright.lights.iter_mut().for_each(|light| light.color *= 1024.0);
    bright.materials.iter_mut().for_each(|material| material.emissive *= 1024.0);
    let all = ToneMap::ALL.map(|curve| (&scene, -1.5_f32, curve));
    for (scene, stops, curve) in all.into_iter().chain([(&bright, -11.5, ToneMap::Neutral)]) {
        let settings = RenderSettings {
            view: View::Direct,
            exposure: Exposure::Stops(stops),
            tone_map: curve,
            frames: 2,
            ..small()
        };
        let picture = render(scene, settings).expect("a picture");
        let is_lit = |pixel: &[u8; 4]| (30..220).contains(&pixel[1]);
        assert!(picture.ldr.iter().filter(|pixel| is_lit(pixel)).count() > 500, "{curve:?}");
        for (hdr, ldr) in picture.hdr.iter().zip(&picture.ldr) {
            let exposed = Vec3::new(hdr[0], hdr[1], hdr[2]) * stops.exp2();
            let code = curve.encode(exposed) * 255.0;
            let shown = Vec3::new(ldr[0].into(), ldr[1].into(), ldr[2].into());
            // The tolerance is for rounding to 8 bits and the driver's pow().
            let error = (shown - code).abs().max_element();
            assert!(error < 0.6, "{curve:?}: {hdr:?} became {shown}, not {code}");
            assert_eq!(ldr[3], 255);
        }
    }
}

/// Cost is shown from dark violet to yellow. `green` is the green of viridis (van der Walt and
/// Smith 2015) at 0, 1/4, 1/2, 3/4 and 1.
#[test]
fn cost_is_shown_as_a_heat_map() {
    let green = [1.0, 82.0, 145.0, 201.0, 231.0];
    let scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
    let picture = render(&scene, RenderSettings { view: View::Cost, bounces: 1, ..small() })
        .expect("a picture");
    let mut middle = 0;
    for (&[samples, ..], ldr) in picture.hdr.iter().zip(&picture.ldr) {
        let place = 4.0 * (samples / COST_SCALE_SAMPLES).min(1.0);
        let (below, share) = (place.floor().min(3.0), place - place.floor().min(3.0));
        let expected = green[below as usize] * (1.0 - share) + green[below as usize + 1] * share;
        let shown = f32::from(ldr[1]);
        assert!((shown - expected).abs() < 10.0, "{samples} samples are {ldr:?}, not {expected}");
        middle += u32::from((0.5..3.5).contains(&place));
    }
    assert!(middle > 500, "{middle} pixels are neither cheap nor dear");
}

#[test]
fn frames_are_averaged() {
    let scene = lumivox_scene::builtin::scene("cornell").expect("a scene");
    let mean_of = |frames| {
        let settings = RenderSettings { view: View::Depth, frames, ..small() };
        render(&scene, settings).expect("a picture")
    };
    // Pixels at smooth edges: the surface's share is neither 0 nor 1.
    let is_partial = |pixel: &&[f32; 4]| pixel[3] > 0.0 && pixel[3] < 1.0;
    assert_eq!(mean_of(1).hdr.iter().filter(is_partial).count(), 0);
    let mean = mean_of(8).hdr;
    assert!(mean.iter().filter(is_partial).count() > 10);
    // All frames have the same weight: of eight, the share is a multiple of an eighth.
    for pixel in &mean {
        let shown = 8.0 * pixel[3];
        assert!((shown - shown.round()).abs() < 1e-4, "{shown} of 8 frames");
    }
}

#[test]
fn invalid_sizes_and_levels_give_typed_errors() {
    let scene = floor_in_the_sun();
    let huge = RenderSettings { size: UVec2::splat(100_000), ..small() };
    let error = render(&scene, huge).expect_err("too large");
    assert!(
        matches!(error, RenderError::Limit { limit: "max_texture_dimension_2d", .. }),
        "{error}"
    );
    let level = RenderSettings { view: View::Voxels, voxel_level: 9, ..small() };
    let error = render(&scene, level).expect_err("no such level");
    assert!(matches!(error, RenderError::Setting { name: "voxel level", .. }), "{error}");
}

#[test]
fn progress_is_reported_and_views_can_be_switched() {
    let scene = floor_in_the_sun();
    let mut seen = Vec::new();
    pollster::block_on(async {
        // All views need an octree, and light of earlier frames.
        let volume = VolumeKind::Octree;
        let trace = TraceSettings { temporal: true, ..TraceSettings::default() };
        let settings = RenderSettings { frames: 2, bounces: 1, volume, trace, ..small() };
        let mut progress = |p: lumivox_render::RenderProgress| seen.push((p.stage, p.done));
        // A separate device, as existing pipelines are not counted.
        let mut renderer = Renderer::new(&own_gpu(), &scene, None, settings, &mut progress).await?;
        for view in View::ALL {
            renderer.set_view(view, 0)?;
            assert_eq!(renderer.frame_count(), 0);
            let picture = renderer.render(&mut progress).await?;
            assert_eq!(renderer.frame_count(), 2);
            assert!(picture.hdr.iter().flatten().all(|value| value.is_finite()), "{view:?}");
        }
        assert!(renderer.memory().iter().any(|used| used.name == "picture" && used.bytes > 0));
        Ok::<(), RenderError>(())
    })
    .expect("all views");
    // One step for each missing pipeline, in order.
    let compiled: Vec<_> = seen.extract_if(.., |step| step.0 == "compile").collect();
    assert!(compiled.len() > 20, "{compiled:?}");
    assert!((0..).zip(&compiled).all(|(done, step)| *step == ("compile", done)), "{compiled:?}");
    assert_eq!(seen[0], ("upload", 0));
    assert_eq!(seen[5], ("light", 1));
    assert_eq!(seen[6..9], [("render", 0), ("render", 1), ("render", 2)]);
}
