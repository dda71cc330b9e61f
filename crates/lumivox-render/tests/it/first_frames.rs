//! Tests that a first frame is close to the mean of many.

use std::ops::ControlFlow;

use glam::UVec2;
use lumivox_render::reference::{PathTracer, ReferenceSettings};
use lumivox_render::{Picture, RenderSettings, View};
use lumivox_scene::{MetallicRoughness, Scene, Shading};

use crate::common::{builtin, gpu, picture, renderer};

fn irradiance(name: &str, frames: u32) -> Picture {
    let settings = RenderSettings {
        size: UVec2::new(64, 48),
        resolution: 64,
        frames,
        view: View::Diffuse,
        ..RenderSettings::default()
    };
    picture(&mut renderer(&gpu(), &builtin(name), settings))
}

/// The median and the 95th percentile (at edges) of the relative difference of lit pixels.
fn noise(picture: &Picture, mean: &Picture) -> [f32; 2] {
    let pairs = picture.hdr.iter().zip(&mean.hdr).filter(|(_, mean)| mean[1] > 1e-3);
    let mut apart: Vec<f32> = pairs.map(|(one, mean)| (one[1] / mean[1] - 1.0).abs()).collect();
    apart.sort_by(f32::total_cmp);
    [0.5, 0.95].map(|share| apart[(apart.len() as f32 * share) as usize])
}

/// With only nine rays a pixel, the first frame's median is 10 % in Cornell and 25 % in the atrium;
/// with one sample a pixel, edges have 94 and 40 %.
#[test]
#[ignore = "slow: over three seconds"]
fn a_first_frame_has_little_noise() {
    for name in ["cornell", "atrium"] {
        let mean = irradiance(name, 32);
        let [first, few] = [1, 8].map(|frames| noise(&irradiance(name, frames), &mean));
        println!("{name}: noise {first:?} in the first frame, {few:?} after eight");
        assert!(first[0] < 0.06 && few[0] < 0.03, "{name}: {first:?}, {few:?}");
        assert!(first[1] < 0.36 && few[1] < 0.15, "{name}: {first:?}, {few:?}");
    }
}

/// The Cornell box as exported by modelling programs: its lamp is the only source, and surfaces
/// have the default gloss.
fn glossy_box() -> Scene {
    let mut scene = builtin("cornell");
    scene.lights.clear();
    for material in &mut scene.materials {
        material.emissive *= 10.0;
        if let Shading::MetallicRoughness(shading) = &mut material.shading {
            let base_color = shading.base_color;
            *shading = MetallicRoughness {
                base_color,
                metallic: 0.0,
                roughness: 0.5,
                ..MetallicRoughness::default()
            };
        }
    }
    scene
}

/// The share of pixels that are more than twice as bright as the brightest of their eight
/// neighbours.
fn stars(picture: &Picture) -> f64 {
    let UVec2 { x: width, y: height } = picture.size;
    let green = |x: u32, y: u32| picture.hdr[(y * width + x) as usize][1];
    let mut stars = 0_u32;
    for (x, y) in (1..height - 1).flat_map(|y| (1..width - 1).map(move |x| (x, y))) {
        let around = (0..9).filter(|i| *i != 4).map(|i| green(x + i % 3 - 1, y + i / 3 - 1));
        stars += u32::from(green(x, y) > 2.0 * around.fold(1e-4, f32::max));
    }
    f64::from(stars) / f64::from(width * height)
}

fn glossy_picture(scene: &Scene, frames: u32) -> Picture {
    let settings = RenderSettings {
        size: UVec2::new(96, 72),
        resolution: 64,
        frames,
        view: View::Specular,
        ..RenderSettings::default()
    };
    picture(&mut renderer(&gpu(), scene, settings))
}

/// The noise would be 25 % if only rays of the lobe found light; with known light it is 18 %.
#[test]
#[ignore = "slow: over three seconds"]
fn rough_reflections_have_little_noise_in_first_frames() {
    let scene = builtin("lacquer");
    let [first, mean] = [1, 64].map(|frames| glossy_picture(&scene, frames));
    let [noise, _] = noise(&first, &mean);
    println!("noise of gloss in the first frame: {noise}");
    assert!(noise < 0.21, "{noise}");
}

/// If only rays of the lobe found the lamp, 1.6 % of the pixels would be stars, in the first frame
/// and after sixteen.
#[test]
#[ignore = "slow: over three seconds"]
fn a_lamp_leaves_no_fireflies_on_glossy_surfaces() {
    let mut pictures = [1, 16].map(|frames| glossy_picture(&glossy_box(), frames));
    let shares = pictures.each_mut().map(|picture| stars(picture));
    println!("stars in the first frame and after 16: {shares:?}");
    assert!(shares.iter().all(|share| *share < 0.002), "{shares:?}");
    let [first, few] =
        pictures.map(|picture| picture.hdr.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>());
    assert!((first / few - 1.0).abs() < 0.06, "{first} is not {few}");
}

/// A metal wall shows only gloss. It is 8 % too bright on llvmpipe; 13 % if only rays of the lobe
/// found the lamp, since its voxels' faces are larger than the lamp.
#[test]
#[ignore = "slow: traces paths"]
fn a_metal_wall_reflects_the_lamp_like_the_reference() {
    let (gpu, mut scene) = (gpu(), glossy_box());
    let red = scene.materials.iter_mut().find(|material| material.name == "red");
    let Some(Shading::MetallicRoughness(red)) = red.map(|material| &mut material.shading) else {
        panic!("no red wall")
    };
    (red.metallic, red.base_color) = (1.0, glam::Vec4::ONE);

    let size = UVec2::new(48, 36);
    let settings = ReferenceSettings { size, samples: 128, ..ReferenceSettings::default() };
    let mut tracer =
        pollster::block_on(PathTracer::new(&gpu, &scene, None, settings)).expect("a path tracer");
    pollster::block_on(tracer.render(&mut |_| ControlFlow::Continue(()))).expect("traced");
    let settings = RenderSettings { size, resolution: 64, frames: 16, ..RenderSettings::default() };
    let ours = picture(&mut renderer(&gpu, &scene, settings)).hdr;
    // Pixels well inside the wall.
    let mean = |radiance: &[[f32; 4]]| -> f32 {
        let pixels = (8..28).flat_map(|y| (8..12).map(move |x| radiance[48 * y + x][1]));
        pixels.sum::<f32>() / 80.0
    };
    let ratio = mean(&ours) / mean(&tracer.layers().picture());
    println!("ours over paths: {ratio}");
    assert!((0.95..=1.1).contains(&ratio), "{ratio}");
}
