//! The noise of a picture of few frames, by blocks of pixels.

use lumivox_render::compare::LinearPicture;
use serde::{Deserialize, Serialize};

/// The edge of a block, in pixels.
pub const BLOCK: usize = 8;
/// Least luminance that errors are relative to, as a share of the median luminance.
const DARK: f32 = 0.02;
/// Relative error from which a pixel is a dot.
const DOT: f32 = 0.5;

/// The noise of a mean of frames, in percent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct BlockNoise {
    /// The root mean square of the relative difference in blocks of 8 x 8 pixels: median and 95th
    /// percentile.
    pub median: f64,
    pub p95: f64,
    /// The share of the pixels that are too bright or too dark by half.
    pub dots: f64,
}

impl BlockNoise {
    /// Compares a picture with a mean of many frames of the same size.
    pub fn new(few: &LinearPicture, many: &LinearPicture) -> Self {
        // ITU-R BT.709-6, section 3.2.
        let luminance = |&[r, g, b]: &[f32; 3]| 0.2126 * r + 0.7152 * g + 0.0722 * b;
        let size = many.size;
        let [few, many]: [Vec<f32>; 2] =
            [few, many].map(|picture| picture.rgb.iter().map(luminance).collect());
        let width = size.x as usize;
        let mut sorted = many.clone();
        sorted.sort_by(f32::total_cmp);
        let least = (DARK * sorted[sorted.len() / 2]).max(f32::MIN_POSITIVE);
        // A black mean has no relative error.
        let relative = |(few, many): (&f32, &f32)| ((few - many) / many.max(least)).min(1e3);
        let relative: Vec<f32> = few.iter().zip(&many).map(relative).collect();
        let height = relative.len() / width;
        let mut blocks = Vec::new();
        for top in (0..height / BLOCK).map(|row| row * BLOCK) {
            for left in (0..width / BLOCK).map(|column| column * BLOCK) {
                let rows = (top..top + BLOCK).flat_map(|y| &relative[y * width + left..][..BLOCK]);
                let squares: f32 = rows.map(|error| error * error).sum();
                blocks.push(f64::from(squares / (BLOCK * BLOCK) as f32).sqrt());
            }
        }
        blocks.sort_by(f64::total_cmp);
        let at = |share: f64| {
            blocks.get((share * blocks.len() as f64) as usize).map_or(0.0, |error| 100.0 * error)
        };
        let dots = relative.iter().filter(|error| error.abs() > DOT).count();
        let dots = 100.0 * dots as f64 / relative.len() as f64;
        Self { median: at(0.5), p95: at(0.95), dots }
    }
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    /// Twelve blocks of brightness 2: one has an error of 10 % in all pixels, one a dot.
    #[test]
    fn block_noise_reports_median_p95_and_dots() {
        let (width, height) = (32, 24);
        let many = LinearPicture { size: UVec2::new(32, 24), rgb: vec![[2.0; 3]; width * height] };
        let mut few = many.clone();
        for y in 0..BLOCK {
            for pixel in &mut few.rgb[y * width..][..BLOCK] {
                *pixel = [2.2; 3];
            }
        }
        few.rgb[width * height - 1] = [4.0; 3];
        let noise = BlockNoise::new(&few, &many);
        assert!(noise.median <= 0.0, "{noise:?}");
        // The worst block: a dot of 100 % in one of 64 pixels.
        assert!((noise.p95 - 12.5).abs() < 1e-3, "{noise:?}");
        assert!((noise.dots - 100.0 / 768.0).abs() < 1e-6, "{noise:?}");
    }
}
