//! Tests that transparent surfaces transmit light in proportion, in pictures and in shadows.

use glam::{UVec2, Vec2, Vec3, Vec4};
use lumivox_render::{RenderSettings, ShadowMethod, View};
use lumivox_scene::{
    AlphaMode, Camera, Light, LightKind, Material, MetallicRoughness, Scene, TextureRef,
    Transmission,
};

use crate::surfaces::stage::*;

/// A glowing material with a coverage of `alpha`.
fn blended(radiance: Vec3, alpha: f32) -> Material {
    let glowing = Material { alpha: AlphaMode::Blend, ..glowing(radiance) };
    with(glowing, |shading| shading.base_color.w = alpha)
}

/// Thin clear glass.
fn glass(color: Vec3, factor: f32) -> Material {
    let shading = MetallicRoughness {
        base_color: color.extend(1.0),
        roughness: 0.0,
        ..MetallicRoughness::default()
    };
    Material { transmission: Transmission { factor, texture: None }, ..metallic_roughness(shading) }
}

#[test]
fn panes_blend_correctly_in_any_order() {
    // Red in front of green in front of blue, added to the scene in both orders.
    for order in [[2.0, 1.0, 0.0], [0.0, 1.0, 2.0]] {
        let mut scene = scene();
        for z in order {
            let material = match z as u32 {
                2 => blended(Vec3::X, 0.3),
                1 => blended(Vec3::Y, 0.5),
                _ => glowing(Vec3::Z),
            };
            add(&mut scene, pane(z), material);
        }
        let expected = Vec3::new(0.3, 0.7 * 0.5, 0.7 * 0.5);
        let one = render(&scene, RenderSettings { frames: 1, ..settings(View::Direct) });
        assert_near("one frame", mean(&one), expected, 0.05);
        let many = render(&scene, settings(View::Direct));
        assert_near("16 frames", mean(&many), expected, 0.02);
        // One random sample a pixel would have an error of 0.47. A first frame has 16 samples, 16
        // frames have 56, evenly spread.
        let (noise_of_one, noise) = (rms(&one, expected), rms(&many, expected));
        println!("noise: {noise_of_one} in one frame, {noise} in 16");
        assert!(noise_of_one < 0.13 && noise < 0.06, "16 frames leave {noise} of {noise_of_one}");
    }
}

/// After 16 frames, a pane seen obliquely has no more noise than one seen straight.
#[test]
fn oblique_panes_are_no_noisier_than_straight_ones() {
    let noise = |along: Vec3| {
        let mut scene = scene();
        add(&mut scene, quad(Vec3::Z, along * 1.5, Vec3::Y), blended(Vec3::X, 0.5));
        add(&mut scene, pane(-1.0), glowing(Vec3::Z));
        let picture = render(&scene, settings(View::Direct));
        let expected = Vec3::new(0.5, 0.0, 0.5);
        // The middle of the picture, which both panes cover.
        let size = picture.size;
        let middle = picture.hdr.iter().enumerate().filter(|(i, _)| {
            let (x, y) = (*i as u32 % size.x, *i as u32 / size.x);
            (10..22).contains(&x) && (4..28).contains(&y)
        });
        let errors: Vec<f32> = middle.map(|(_, p)| (p[0] - expected.x).powi(2)).collect();
        (errors.iter().sum::<f32>() / errors.len() as f32).sqrt()
    };
    let (straight, oblique) = (noise(Vec3::X), noise(Vec3::new(0.8, 0.0, 0.6)));
    println!("noise: {straight} straight, {oblique} oblique");
    // Random samples would leave a noise of 0.125, a sequence scrambled within strata 0.027.
    assert!(straight < 0.02 && oblique < 0.02, "{straight} {oblique}");
}

#[test]
fn panes_of_one_mesh_are_drawn_independently() {
    let mut scene = scene();
    add(&mut scene, joined(pane(1.0), pane(0.9)), blended(Vec3::X, 0.5));
    add(&mut scene, pane(0.0), glowing(Vec3::Z));
    let many = render(&scene, RenderSettings { frames: 64, ..settings(View::Direct) });
    assert_near("two panes of one half", mean(&many), Vec3::new(0.75, 0.0, 0.25), 0.02);
    // Also for both sides of a closed shape.
    let mut scene = self::scene();
    let sides = joined(pane(1.0), quad(Vec3::Z * 0.9, -Vec3::X, Vec3::Y));
    let material = Material { double_sided: true, ..blended(Vec3::X, 0.5) };
    add(&mut scene, sides, material);
    add(&mut scene, pane(0.0), glowing(Vec3::Z));
    let many = render(&scene, RenderSettings { frames: 64, ..settings(View::Direct) });
    assert_near("two sides of one half", mean(&many), Vec3::new(0.75, 0.0, 0.25), 0.02);
}

/// A white pane with a coverage of a fifth is invisible under a uniform sky, even in pixels without
/// a traced sample of the pane nearby to take indirect light from.
#[test]
fn a_faint_pane_has_indirect_light_in_every_pixel() {
    let mut scene = scene();
    scene.environment.radiance = Vec3::ONE;
    let material = Material { alpha: AlphaMode::Blend, ..Material::diffuse("white", Vec3::ONE) };
    add(&mut scene, pane(0.0), with(material, |shading| shading.base_color.w = 0.2));
    let lit = RenderSettings { bounces: 1, frames: 1, ..settings(View::Final) };
    let darkest = render(&scene, lit).hdr.iter().map(|p| p[0]).fold(f32::MAX, f32::min);
    println!("darkest pixel: {darkest}");
    assert!(darkest > 0.99, "a pixel has {darkest} of the light");
}

#[test]
fn opacity_multiplies_texture_and_vertex_alpha() {
    let mut scene = scene();
    scene.textures.push(texture(2, 1, |x, _| [255, 255, 255, if x == 0 { 51 } else { 204 }]));
    let material = with(blended(Vec3::X, 1.0), |shading| {
        shading.base_color_texture = Some(TextureRef::new(0));
    });
    let mut mesh = pane(1.0);
    mesh.colors = vec![Vec4::new(1.0, 1.0, 1.0, 0.5); 4];
    add(&mut scene, mesh, material);
    add(&mut scene, pane(0.0), glowing(Vec3::Z));
    let picture = render(&scene, settings(View::Direct));
    let left = mean_of(&picture, UVec2::ZERO, UVec2::new(15, 32));
    let right = mean_of(&picture, UVec2::new(17, 0), UVec2::new(32, 32));
    assert_near("a fifth of a half", left, Vec3::new(0.1, 0.0, 0.9), 0.02);
    assert_near("four fifths of a half", right, Vec3::new(0.4, 0.0, 0.6), 0.02);
}

#[test]
fn glass_tints_what_is_behind_it() {
    let color = Vec3::new(0.9, 0.3, 0.0);
    let mut scene = scene();
    add(&mut scene, pane(1.0), glass(color, 0.8));
    add(&mut scene, pane(0.0), glowing(Vec3::ONE));
    let picture = render(&scene, settings(View::Direct));
    assert_near("one pane", mean(&picture), 0.96 * 0.8 * color, 0.01);
    add(&mut scene, pane(1.1), glass(Vec3::new(0.5, 1.0, 1.0), 1.0));
    let picture = render(&scene, RenderSettings { frames: 64, ..settings(View::Direct) });
    let expected = 0.96 * 0.96 * 0.8 * color * Vec3::new(0.5, 1.0, 1.0);
    assert_near("two panes", mean(&picture), expected, 0.015);
    // Metal does not transmit light.
    let mut scene = self::scene();
    add(&mut scene, pane(1.0), with(glass(color, 1.0), |shading| shading.metallic = 1.0));
    add(&mut scene, pane(0.0), glowing(Vec3::ONE));
    assert_near("metal", mean(&render(&scene, settings(View::Direct))), Vec3::ZERO, 0.0);
}

/// Under a uniform sky, clear glass is invisible: reflected and transmitted light add up to one. In
/// front of a black wall it shows only the reflection.
#[test]
#[ignore = "slow: over three seconds"]
fn reflected_and_transmitted_light_of_glass_add_up() {
    for angle in [0.0_f32, 1.1] {
        let mut scene = scene();
        scene.environment.radiance = Vec3::ONE;
        let (sine, cosine) = angle.sin_cos();
        let tilted = quad(Vec3::Z, Vec3::new(cosine, 0.0, -sine) * 3.0, Vec3::Y);
        add(&mut scene, tilted, glass(Vec3::ONE, 1.0));
        let lit = RenderSettings { bounces: 1, ..settings(View::Final) };
        let clear = mean(&render(&scene, lit.clone()));
        assert_near("clear glass under a sky", clear, Vec3::ONE, 0.02);
        // Tinted glass, half of it diffuse, over black: Schlick's term, plus half of the light that
        // enters. The share that enters is a mean over directions of light, each at half its angle
        // to the camera.
        scene.materials[0] = glass(Vec3::new(0.5, 1.0, 0.2), 0.5);
        add(&mut scene, quad(-Vec3::Z, Vec3::X * 1.2, Vec3::Y * 1.2), glowing(Vec3::ZERO));
        let fresnel = 0.04 + 0.96 * (1.0 - cosine).powi(5);
        let enters = 0.96 * (1.0 - half_angle_fresnel(angle));
        let expected = fresnel + enters * 0.5 * Vec3::new(0.5, 1.0, 0.2);
        let milky = mean(&render(&scene, RenderSettings { frames: 64, ..lit }));
        assert_near("milky glass over black", milky, expected, 0.03);
    }
}

/// The mean of (1 - cosine)^5 at the half vectors to a camera, over uniform light.
fn half_angle_fresnel(angle: f32) -> f32 {
    const STEPS: u32 = 200;
    let view = Vec3::new(angle.sin(), 0.0, angle.cos());
    let places = (0..STEPS * STEPS).map(|i| (i % STEPS, i / STEPS));
    let terms = places.map(|(ring, turn)| {
        let sine = ((ring as f32 + 0.5) / STEPS as f32).sqrt();
        let (y, x) = (std::f32::consts::PI * (turn as f32 + 0.5) / STEPS as f32).sin_cos();
        let light = Vec3::new(sine * x, sine * y, (1.0 - sine * sine).sqrt());
        (1.0 - (light + view).normalize().dot(view)).powi(5)
    });
    terms.sum::<f32>() / (STEPS * STEPS) as f32
}

/// A floor in the sun. A roof of the given material shadows all of the visible part.
fn under_a_roof(roof: Material) -> Scene {
    let mut scene = scene();
    let white = Material::diffuse("floor", Vec3::ONE);
    add(&mut scene, quad(Vec3::ZERO, Vec3::X * 2.0, Vec3::NEG_Z * 2.0), white);
    // Double-sided: cones pass the back of a single-sided surface.
    let roof = Material { double_sided: true, ..roof };
    add(&mut scene, quad(Vec3::Y * 1.5, Vec3::X * 2.0, Vec3::NEG_Z * 2.0), roof);
    scene.cameras = vec![Camera::look_at(Vec3::new(0.0, 0.9, 0.4), Vec3::ZERO, 0.4)];
    scene.lights.push(Light {
        kind: LightKind::Directional,
        intensity: 1.0,
        direction: Vec3::new(0.2, -1.0, 0.15).normalize(),
        ..Light::default()
    });
    scene
}

#[test]
#[ignore = "slow: over three seconds"]
fn shadow_depth_follows_the_casters_opacity() {
    let black = Vec3::ZERO;
    let mut leaf = Material { alpha: AlphaMode::Mask { cutoff: 0.5 }, ..glowing(black) };
    leaf = with(leaf, |shading| shading.base_color_texture = Some(TextureRef::new(0)));
    // The grey glass has a luminance of 0.5.
    let roofs = [
        ("a blend of a half", blended(black, 0.5), 0.5),
        ("grey glass", glass(Vec3::splat(0.5), 0.8), 1.0 - 0.96 * 0.4),
        ("a leaf", leaf, 0.5),
        ("a whole roof", Material::diffuse("roof", black), 0.0),
    ];
    for (what, roof, passing) in roofs {
        let passing = if what == "grey glass" { 1.0 - passing } else { passing };
        let mut scene = under_a_roof(roof);
        // Squares of about 20 texels of the shadow map: holes, without mips.
        let mut checker = texture(2, 2, |x, y| [0, 0, 0, if x == y { 255 } else { 0 }]);
        checker.sampler.minify = lumivox_scene::Filter::Nearest;
        scene.textures.push(checker);
        for uv in &mut scene.meshes[1].uvs {
            *uv *= 20.0;
        }
        for shadows in [ShadowMethod::Map, ShadowMethod::Cone] {
            let settings = RenderSettings { shadows, frames: 4, ..settings(View::Shadow) };
            let picture = render(&scene, settings);
            let what = format!("{what}, {shadows:?}");
            // In voxels, glass reflects the mean over the hemisphere, 9 % instead of 4, and each
            // voxel samples the leaf once.
            let is_even = what.starts_with("a blend") || what == "a whole roof";
            let tolerance = match shadows {
                ShadowMethod::Cone if is_even => 0.005,
                ShadowMethod::Cone => 0.035,
                ShadowMethod::Map => 0.015,
            };
            assert_near(&what, mean(&picture), Vec3::splat(passing), tolerance);
            // Filtering removes the pattern of the map's texels, but not the leaf's holes.
            let noise = rms(&picture, mean(&picture));
            println!("noise {noise}");
            assert!(
                what.contains("leaf") || noise < 0.12,
                "{what}: the shadow has a noise of {noise}"
            );
        }
    }
    // Two roofs with a coverage of a half let a quarter through.
    let mut scene = under_a_roof(blended(black, 0.5));
    let second = quad(Vec3::Y * 1.4, Vec3::X * 2.0, Vec3::NEG_Z * 2.0);
    let first = scene.meshes.pop().expect("the roof");
    scene.meshes.push(joined(first, second));
    let picture = render(&scene, RenderSettings { frames: 4, ..settings(View::Shadow) });
    assert_near("two roofs", mean(&picture), Vec3::splat(0.25), 0.03);
}

/// Leaves that cover a quarter, a half and three quarters, between the sky and a floor with black
/// walls. The rest of the sky's light reaches the floor, gathered by cones through voxels.
#[test]
#[ignore = "slow: over three seconds"]
fn leaves_let_the_skys_light_through_in_proportion() {
    let irradiance = |quarters: Option<u32>| {
        let mut scene = scene();
        scene.environment.radiance = Vec3::ONE;
        let black = Material { double_sided: true, ..Material::diffuse("wall", Vec3::ZERO) };
        add(
            &mut scene,
            quad(Vec3::ZERO, Vec3::X, Vec3::NEG_Z),
            Material::diffuse("floor", Vec3::ONE),
        );
        for (center, u) in
            [(Vec3::X, Vec3::Z), (-Vec3::X, Vec3::Z), (Vec3::Z, Vec3::X), (-Vec3::Z, Vec3::X)]
        {
            add(&mut scene, quad(center + Vec3::Y * 0.5, u, Vec3::Y * 0.5), black.clone());
        }
        // The texture repeats 32 times along an edge of 64 voxels, so a texel is as large as a
        // voxel.
        scene.textures.push(texture(2, 2, |x, y| {
            let is_there = quarters
                .is_some_and(|quarters| [[0, 2], [3, 1]][y as usize][x as usize] < quarters);
            [0, 0, 0, if is_there { 255 } else { 0 }]
        }));
        if quarters.is_some() {
            let mut leaves = quad(Vec3::Y * 0.7, Vec3::X, Vec3::NEG_Z);
            // Avoid samples at a texel's edge, where the GPU's rounding would decide.
            for uv in &mut leaves.uvs {
                *uv = *uv * 32.0 + Vec2::new(0.037, 0.059);
            }
            let mut leaf = Material { alpha: AlphaMode::Mask { cutoff: 0.5 }, ..black };
            leaf = with(leaf, |shading| shading.base_color_texture = Some(TextureRef::new(0)));
            add(&mut scene, leaves, leaf);
        }
        scene.cameras = vec![Camera::look_at(Vec3::new(0.0, 0.6, 0.0), Vec3::ZERO, 0.8)];
        let settings = RenderSettings { bounces: 1, resolution: 64, ..settings(View::Diffuse) };
        mean(&render(&scene, settings)).x
    };
    let open = irradiance(None);
    for quarters in 1..=3 {
        let expected = 1.0 - quarters as f32 / 4.0;
        let share = irradiance(Some(quarters)) / open;
        println!("{share:.4} of {expected}");
        assert!((share - expected).abs() < 0.03, "{share}, not {expected}");
    }
}

#[test]
fn transparent_scenes_render_the_same_bits_twice() {
    let mut scene = scene();
    add(&mut scene, pane(1.0), blended(Vec3::X, 0.4));
    add(&mut scene, pane(0.5), glass(Vec3::new(0.2, 0.9, 0.5), 0.7));
    add(&mut scene, pane(0.0), glowing(Vec3::Z));
    let bits = || {
        let picture = render(&scene, RenderSettings { frames: 3, ..settings(View::Direct) });
        picture.hdr.iter().map(|pixel| pixel.map(f32::to_bits)).collect::<Vec<_>>()
    };
    assert!(bits() == bits(), "two runs differ");
}
