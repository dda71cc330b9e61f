//! A first frame shows what many frames show: light from afar is not drawn.

use glam::UVec2;
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

/// The median of the relative difference over the pixels that are lit: borders of things, where pixels are jittered, are few.
fn noise(picture: &Picture, mean: &Picture) -> f32 {
    let pairs = picture.hdr.iter().zip(&mean.hdr).filter(|(_, mean)| mean[1] > 1e-3);
    let mut apart: Vec<f32> = pairs.map(|(one, mean)| (one[1] / mean[1] - 1.0).abs()).collect();
    apart.sort_by(f32::total_cmp);
    apart[apart.len() / 2]
}

/// Nine rays a pixel alone leave 10 % in Cornell and 25 % in the atrium.
#[test]
fn a_first_frame_is_smooth() {
    for name in ["cornell", "atrium"] {
        let mean = irradiance(name, 64);
        let [first, few] = [1, 8].map(|frames| noise(&irradiance(name, frames), &mean));
        println!("{name}: noise {first} in the first frame, {few} after eight");
        assert!(first < 0.06 && few < 0.03, "{name}: {first}, {few}");
    }
}

/// The Cornell box as modelling programs export it: its lamp alone shines, on surfaces with a default's gloss.
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

/// The share of pixels that reflect more than twice as much as the brightest of the eight around them.
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

/// Where only rays of the lobe find a lamp, 1.6 % of the pixels of such a box are stars, in a first frame and after sixteen.
#[test]
fn a_lamp_leaves_no_stars_on_gloss() {
    let mut pictures = [1, 16].map(|frames| {
        let settings = RenderSettings {
            size: UVec2::new(96, 72),
            resolution: 64,
            frames,
            view: View::Specular,
            ..RenderSettings::default()
        };
        picture(&mut renderer(&gpu(), &glossy_box(), settings))
    });
    let shares = pictures.each_mut().map(|picture| stars(picture));
    println!("stars in the first frame and after 16: {shares:?}");
    assert!(shares.iter().all(|share| *share < 0.002), "{shares:?}");
    let [first, few] =
        pictures.map(|picture| picture.hdr.iter().map(|pixel| f64::from(pixel[1])).sum::<f64>());
    assert!((first / few - 1.0).abs() < 0.06, "{first} is not {few}");
}
