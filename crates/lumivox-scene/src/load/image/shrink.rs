//! Halving the size of images.
//!
//! A texel of the result is the mean of the rectangle that it covers; texels at the border count
//! with the share that is inside (for edges of odd length). Colours are averaged as linear light,
//! weighted by their alpha, so that invisible texels do not bleed into visible ones; data is
//! averaged without conversion.

use super::Pixels;
use crate::load::color::{linear_from_srgb, srgb_from_linear};

/// The meaning of a texture's numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(in crate::load) enum Encoding {
    /// sRGB-encoded colours with a linear alpha.
    Color,
    /// Four independent linear numbers.
    Data,
}

/// A length after `times` halvings.
pub(in crate::load) fn halved(length: u32, times: u32) -> u32 {
    length.checked_shr(times).unwrap_or(0).max(1)
}

/// Halves both edges of an image `times` times.
pub(in crate::load) fn shrink(pixels: Pixels, times: u32, encoding: Encoding) -> Pixels {
    if times == 0 {
        return pixels;
    }
    let (width, height) = (halved(pixels.width, times), halved(pixels.height, times));
    let (columns, rows) = (covers(pixels.width, width), covers(pixels.height, height));
    let light: [f32; 256] = std::array::from_fn(|i| linear_from_srgb(i as f32 / 255.0));
    let mut rgba8 = Vec::with_capacity(width as usize * height as usize * 4);
    for row in &rows {
        for column in &columns {
            // Sums of colour weighted by alpha, colour, alpha, and weight.
            let (mut seen, mut all, mut alpha, mut weight) = ([0.0; 3], [0.0; 3], 0.0, 0.0);
            for (y, wy) in row.iter() {
                let begin = (y * pixels.width as usize + column.first) * 4;
                for (texel, (_, wx)) in pixels.rgba8[begin..].chunks_exact(4).zip(column.iter()) {
                    let w = wx * wy;
                    let a = w * f32::from(texel[3]) / 255.0;
                    for c in 0..3 {
                        let value = match encoding {
                            Encoding::Color => light[usize::from(texel[c])],
                            Encoding::Data => f32::from(texel[c]) / 255.0,
                        };
                        seen[c] += value * a;
                        all[c] += value * w;
                    }
                    alpha += a;
                    weight += w;
                }
            }
            let to_byte = |value: f32| (value.clamp(0.0, 1.0) * 255.0).round() as u8;
            for c in 0..3 {
                rgba8.push(match encoding {
                    Encoding::Color if alpha > 0.0 => to_byte(srgb_from_linear(seen[c] / alpha)),
                    Encoding::Color => to_byte(srgb_from_linear(all[c] / weight)),
                    Encoding::Data => to_byte(all[c] / weight),
                });
            }
            rgba8.push(to_byte(alpha / weight));
        }
    }
    Pixels { width, height, rgba8 }
}

/// The texels under a texel of the result along one edge, with their shares.
struct Cover {
    first: usize,
    weights: Vec<f32>,
}

impl Cover {
    fn iter(&self) -> impl Iterator<Item = (usize, f32)> + '_ {
        self.weights.iter().enumerate().map(|(i, &w)| (self.first + i, w))
    }
}

fn covers(from: u32, to: u32) -> Vec<Cover> {
    let (from, to) = (u64::from(from), u64::from(to));
    let cover = |i: u64| {
        // In units of 1 / `to` of a texel, all numbers are integers.
        let (begin, end) = (i * from, (i + 1) * from);
        let (first, last) = (begin / to, end.div_ceil(to));
        let inside = |texel: u64| end.min((texel + 1) * to) - begin.max(texel * to);
        Cover {
            first: first as usize,
            weights: (first..last).map(|texel| inside(texel) as f32 / to as f32).collect(),
        }
    };
    (0..to).map(cover).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn pixels(width: u32, height: u32, texels: &[[u8; 4]]) -> Pixels {
        Pixels { width, height, rgba8: texels.as_flattened().to_vec() }
    }

    #[test]
    fn colours_are_averaged_linearly_and_data_directly() {
        let board =
            pixels(2, 2, &[[255, 255, 0, 255], [0, 0, 0, 255], [0, 0, 0, 255], [255, 255, 0, 255]]);
        // Half the light has the sRGB code 188.
        let color = shrink(board.clone(), 1, Encoding::Color);
        assert_eq!(color, pixels(1, 1, &[[188, 188, 0, 255]]));
        assert_eq!(shrink(board.clone(), 1, Encoding::Data), pixels(1, 1, &[[128, 128, 0, 255]]));
        assert_eq!(shrink(board.clone(), 0, Encoding::Data), board);
    }

    #[test]
    fn transparent_texels_do_not_bleed_when_shrinking() {
        let leaf = pixels(2, 1, &[[0, 200, 0, 255], [255, 0, 255, 0]]);
        assert_eq!(shrink(leaf, 1, Encoding::Color), pixels(1, 1, &[[0, 200, 0, 128]]));
    }

    #[test]
    fn odd_sizes_shrink_without_losing_texels() {
        // Five texels become two: each covers two and a half.
        let row = pixels(5, 1, &[[0; 4], [0; 4], [200; 4], [100; 4], [50; 4]]);
        let half = shrink(row, 1, Encoding::Data);
        assert_eq!(half, pixels(2, 1, &[[40; 4], [100; 4]]));
        // Down to one texel, and no further.
        let flat = pixels(7, 3, &[[90; 4]; 21]);
        assert_eq!(shrink(flat, 9, Encoding::Data), pixels(1, 1, &[[90; 4]]));
        assert_eq!((halved(16, 2), halved(5, 40)), (4, 1));
    }
}
