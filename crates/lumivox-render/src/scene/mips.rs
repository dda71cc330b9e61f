//! Mip chains, computed on the CPU in linear light.
//!
//! Each texel of a level is the mean of the area that it covers on the level above (a box filter;
//! for odd sizes, texels at the seams count with their covered share). Colours are averaged as
//! light, not as their sRGB codes: averaging codes darkens (Gritz and d'Eon 2007, "The importance
//! of being linear", GPU Gems 3, section 24.3.2).

use glam::{Vec4, Vec4Swizzles as _};
use lumivox_scene::Texture;
use rayon::prelude::*;

use crate::picture::srgb::{srgb_decode, srgb_encode};

/// The meaning of an image's bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(crate) enum Encoding {
    /// Colours, sRGB-encoded; alpha is linear.
    Color,
    /// Linear numbers.
    Data,
}

/// The meaning of an image's alpha.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Alpha {
    /// Independent data.
    Data,
    /// Coverage: the colour of a texel counts for the covered share.
    Coverage,
    /// A mask: texels with an alpha of at least the cutoff exist, the others do not.
    Mask(f32),
}

/// One level of a mip chain.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Level {
    pub(crate) width: u32,
    pub(crate) height: u32,
    pub(crate) rgba8: Vec<u8>,
}

/// The weight of fully transparent texels in the mean colour: negligible beside an opaque texel (a
/// sixteenth of an 8-bit step), decisive if all are transparent.
const TRANSPARENT_WEIGHT: f32 = 1.0 / 4096.0;

/// The levels of an image, from its full size down to one texel.
///
/// With a mask, alpha becomes 1 if it is at least the cutoff and 0 otherwise, so that alpha in the
/// coarser levels is the covered share. If alpha is coverage, the colour of coarser levels is the
/// mean of the covered parts: the transparent parts of a leaf's image may have any colour.
pub(crate) fn mip_chain(texture: &Texture, encoding: Encoding, alpha_use: Alpha) -> Vec<Level> {
    let decode = decoding_table(encoding);
    let mut texels: Vec<Vec4> = texture
        .rgba8
        .par_chunks_exact(4)
        .map(|t| {
            let [r, g, b] = [t[0], t[1], t[2]].map(|byte| decode[usize::from(byte)]);
            let alpha = f32::from(t[3]) / 255.0;
            let covered = match alpha_use {
                Alpha::Data => return Vec4::new(r, g, b, alpha),
                Alpha::Coverage => alpha,
                Alpha::Mask(cutoff) => f32::from(u8::from(alpha >= cutoff)),
            };
            let weight = covered + TRANSPARENT_WEIGHT;
            Vec4::new(r * weight, g * weight, b * weight, weight)
        })
        .collect();
    let (mut width, mut height) = (texture.width as usize, texture.height as usize);
    let mut levels = Vec::new();
    loop {
        let rgba8 = encode(&texels, encoding, alpha_use != Alpha::Data);
        levels.push(Level { width: width as u32, height: height as u32, rgba8 });
        if width == 1 && height == 1 {
            return levels;
        }
        texels = halve(&texels, width, height);
        (width, height) = ((width / 2).max(1), (height / 2).max(1));
    }
}

/// The mean over each texel of the next level.
fn halve(texels: &[Vec4], width: usize, height: usize) -> Vec<Vec4> {
    let columns = taps(width);
    let rows = taps(height);
    let mut halved = vec![Vec4::ZERO; columns.len() * rows.len()];
    halved.par_chunks_exact_mut(columns.len()).zip(&rows).for_each(|(line, row)| {
        for (texel, column) in line.iter_mut().zip(&columns) {
            for &(y, weight_y) in row {
                for &(x, weight_x) in column {
                    *texel += texels[y * width + x] * (weight_x * weight_y);
                }
            }
        }
    });
    halved
}

/// For each texel of the next level along one axis, the texels that it covers with their weights,
/// which sum to 1.
fn taps(length: usize) -> Vec<Vec<(usize, f32)>> {
    let halved = (length / 2).max(1);
    (0..halved)
        .map(|i| {
            // In units of a texel / `halved`, in which all borders are integers.
            let (start, end) = (i * length, (i + 1) * length);
            (start / halved..end.div_ceil(halved))
                .map(|texel| {
                    let covered = end.min((texel + 1) * halved) - start.max(texel * halved);
                    (texel, covered as f32 / length as f32)
                })
                .collect()
        })
        .collect()
}

fn encode(texels: &[Vec4], encoding: Encoding, is_weighted: bool) -> Vec<u8> {
    let byte = |x: f32| (x * 255.0).round().clamp(0.0, 255.0) as u8;
    texels
        .par_iter()
        .flat_map_iter(|&texel| {
            let texel = if is_weighted {
                (texel.xyz() / texel.w).extend(texel.w - TRANSPARENT_WEIGHT)
            } else {
                texel
            };
            let color = match encoding {
                Encoding::Color => texel.xyz().map(srgb_encode),
                Encoding::Data => texel.xyz(),
            };
            [byte(color.x), byte(color.y), byte(color.z), byte(texel.w)]
        })
        .collect()
}

fn decoding_table(encoding: Encoding) -> [f32; 256] {
    std::array::from_fn(|byte| {
        let code = byte as f32 / 255.0;
        match encoding {
            Encoding::Color => srgb_decode(code),
            Encoding::Data => code,
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texture(width: u32, height: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> Texture {
        let rgba8 = (0..height).flat_map(|y| (0..width).flat_map(move |x| [(x, y)]));
        let rgba8 = rgba8.flat_map(|(x, y)| texel(x, y)).collect();
        Texture {
            name: String::new(),
            width,
            height,
            rgba8,
            sampler: lumivox_scene::Sampler::default(),
        }
    }

    fn last(levels: &[Level]) -> [u8; 4] {
        levels.last().expect("a level").rgba8[..].try_into().expect("one texel")
    }

    #[test]
    fn the_finest_level_is_the_image_itself() {
        let image = texture(17, 5, |x, y| [x as u8 * 15, y as u8 * 50, 7, 200]);
        for encoding in [Encoding::Color, Encoding::Data] {
            let levels = mip_chain(&image, encoding, Alpha::Data);
            assert_eq!(levels[0].rgba8, image.rgba8);
            let sizes: Vec<_> = levels.iter().map(|l| (l.width, l.height)).collect();
            assert_eq!(sizes, [(17, 5), (8, 2), (4, 1), (2, 1), (1, 1)]);
        }
    }

    #[test]
    fn black_and_white_average_to_half_the_light() {
        let checker =
            texture(4, 4, |x, y| if (x + y) % 2 == 0 { [255; 4] } else { [0, 0, 0, 255] });
        // Half the light is sRGB code 188, half the code 128.
        assert_eq!(last(&mip_chain(&checker, Encoding::Color, Alpha::Data)), [188, 188, 188, 255]);
        assert_eq!(last(&mip_chain(&checker, Encoding::Data, Alpha::Data)), [128, 128, 128, 255]);
    }

    #[test]
    fn odd_sizes_keep_the_mean() {
        // One white column of 5 or 7 gives a mean of a fifth or a seventh, wherever it is.
        for width in [5, 7] {
            for white in 0..width {
                let image = texture(width, 3, |x, _| if x == white { [255; 4] } else { [0; 4] });
                let [r, ..] = last(&mip_chain(&image, Encoding::Data, Alpha::Data));
                assert_eq!(r, (255.0 / width as f32).round() as u8, "column {white} of {width}");
            }
        }
    }

    #[test]
    fn a_mask_becomes_coverage_and_keeps_its_colour() {
        // A quarter is opaque red, the rest is nearly transparent green.
        let leaf =
            texture(4, 4, |x, y| if x < 2 && y < 2 { [255, 0, 0, 200] } else { [0, 255, 0, 100] });
        let levels = mip_chain(&leaf, Encoding::Color, Alpha::Mask(0.5));
        assert_eq!(levels[0].rgba8[..4], [255, 0, 0, 255]);
        assert_eq!(levels[0].rgba8[12..16], [0, 255, 0, 0]);
        let [r, g, _, a] = last(&levels);
        assert_eq!(a, 64);
        assert!(r >= 254 && g <= 10, "{r} {g}");
    }

    #[test]
    fn transparent_texels_do_not_tint_visible_ones() {
        // Half is red glass with a coverage of a fifth, half is empty, stored as white.
        let pane = texture(4, 4, |x, _| if x < 2 { [255, 0, 0, 51] } else { [255, 255, 255, 0] });
        let levels = mip_chain(&pane, Encoding::Color, Alpha::Coverage);
        assert_eq!(levels[0].rgba8, pane.rgba8);
        let [r, g, _, a] = last(&levels);
        assert!(a.abs_diff(26) <= 1, "{a}");
        assert!(r >= 254 && g <= 20, "{r} {g}");
    }
}
