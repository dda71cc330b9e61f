//! A first frame shows what many frames show: light from afar is not drawn.

use glam::UVec2;
use lumivox_render::{Picture, RenderSettings, View};

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

/// Blocks of 8 x 8 pixels: the median of the root mean square of the relative difference.
fn noise(picture: &Picture, mean: &Picture) -> f32 {
    let mut blocks: Vec<f32> = (0..48)
        .map(|block| {
            let corner = (block / 8 * 8 * 64 + block % 8 * 8) as usize;
            let pixels = (0..64).map(|pixel| corner + pixel / 8 * 64 + pixel % 8);
            let of = |pixel: usize| picture.hdr[pixel][1] / mean.hdr[pixel][1].max(1e-3) - 1.0;
            (pixels.map(|pixel| of(pixel).powi(2)).sum::<f32>() / 64.0).sqrt()
        })
        .collect();
    blocks.sort_by(f32::total_cmp);
    blocks[24]
}

/// Nine rays a pixel would leave 15 %.
#[test]
fn a_first_frame_is_smooth() {
    for name in ["cornell", "atrium"] {
        let mean = irradiance(name, 64);
        let [first, few] = [1, 8].map(|frames| noise(&irradiance(name, frames), &mean));
        println!("{name}: noise {first} in the first frame, {few} after eight");
        assert!(first < 0.08 && few < 0.03, "{name}: {first}, {few}");
    }
}
