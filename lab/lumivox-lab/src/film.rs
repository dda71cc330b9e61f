//! Animated PNG files (W3C 2025, "Portable Network Graphics, third edition", section 11.3.4) of at
//! most 256 colours.

use std::collections::BTreeMap;

use anyhow::ensure;
use image::RgbImage;
use png::{BitDepth, ColorType, Compression, Encoder, Filter};

/// The most colours of a palette.
const MOST_COLORS: usize = 256;
/// Bits per channel for counting colours: few enough that noise does not split a colour.
const COUNTED_BITS: u32 = 5;

/// Encodes frames of one size as an animation that repeats forever; each is shown for `delay_ms`.
///
/// All share one palette: the most frequent colours of all frames, by 5 bits a channel. Other
/// colours become the nearest of these.
///
/// # Errors
/// When there are no frames or their sizes differ.
pub fn film(frames: &[RgbImage], delay_ms: u16) -> anyhow::Result<Vec<u8>> {
    ensure!(!frames.is_empty(), "there are no frames to show");
    let (width, height) = frames[0].dimensions();
    let is_alike = frames.iter().all(|frame| frame.dimensions() == (width, height));
    ensure!(is_alike, "the frames of an animation must have one size");
    let palette = palette(frames);
    let mut bytes = Vec::new();
    let mut encoder = Encoder::new(&mut bytes, width, height);
    encoder.set_color(ColorType::Indexed);
    encoder.set_depth(BitDepth::Eight);
    encoder.set_palette(palette.as_flattened().to_vec());
    encoder.set_compression(Compression::High);
    // PNG filters do not help palette indices.
    encoder.set_filter(Filter::NoFilter);
    encoder.set_animated(frames.len() as u32, 0)?;
    encoder.set_frame_delay(delay_ms, 1000)?;
    let mut writer = encoder.write_header()?;
    let mut known = BTreeMap::new();
    for frame in frames {
        let index = |color: [u8; 3]| {
            *known.entry(key(color)).or_insert_with(|| nearest(&palette, middle(key(color))))
        };
        let indices: Vec<u8> = frame.pixels().map(|pixel| pixel.0).map(index).collect();
        writer.write_image_data(&indices)?;
    }
    writer.finish()?;
    Ok(bytes)
}

/// The leading bits of a colour.
fn key(color: [u8; 3]) -> [u8; 3] {
    color.map(|channel| channel >> (8 - COUNTED_BITS))
}

/// The middle of the colours with these leading bits; exact for black and white.
fn middle(key: [u8; 3]) -> [u8; 3] {
    let most = (1_u32 << COUNTED_BITS) - 1;
    key.map(|bits| ((u32::from(bits) * 255 + most / 2) / most) as u8)
}

/// The most frequent colours, by descending frequency.
fn palette(frames: &[RgbImage]) -> Vec<[u8; 3]> {
    let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
    for pixel in frames.iter().flat_map(RgbImage::pixels) {
        *counts.entry(key(pixel.0)).or_default() += 1;
    }
    let mut keys: Vec<([u8; 3], usize)> = counts.into_iter().collect();
    // Stable: equally frequent colours stay in the order of their values.
    keys.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
    keys.into_iter().take(MOST_COLORS).map(|(key, _)| middle(key)).collect()
}

fn nearest(palette: &[[u8; 3]], color: [u8; 3]) -> u8 {
    let distance = |other: &[u8; 3]| -> u32 {
        other.iter().zip(color).map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum()
    };
    let best = (0..palette.len()).min_by_key(|&index| distance(&palette[index]));
    best.unwrap_or_default() as u8
}

#[cfg(test)]
mod tests {
    use image::Rgb;
    use png::Decoder;

    use super::*;

    #[test]
    fn encoded_film_keeps_frame_order_and_colors() {
        let colors = [[255, 0, 0], [0, 255, 0], [0, 0, 0], [255, 255, 255]];
        let frames: Vec<RgbImage> = (0..3)
            .map(|first| {
                RgbImage::from_fn(4, 2, |x, y| Rgb(colors[(first + x as usize + y as usize) % 4]))
            })
            .collect();
        let bytes = film(&frames, 120).unwrap();
        let mut decoder = Decoder::new(std::io::Cursor::new(&bytes));
        decoder.set_transformations(png::Transformations::EXPAND);
        let mut reader = decoder.read_info().unwrap();
        let control = *reader.info().animation_control().unwrap();
        assert_eq!((control.num_frames, control.num_plays), (3, 0));
        for frame in &frames {
            let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
            reader.next_frame(&mut pixels).unwrap();
            assert_eq!(&pixels, frame.as_raw());
            let shown = reader.info().frame_control().unwrap();
            assert_eq!((shown.delay_num, shown.delay_den), (120, 1000));
        }
        assert_eq!(bytes, film(&frames, 120).unwrap());
    }

    /// Half of the frame has one colour, the other half thousands: the palette contains the former.
    #[test]
    fn the_palette_keeps_frequent_colors() {
        let wall = Rgb([200, 101, 50]);
        let frame = RgbImage::from_fn(128, 64, |x, y| {
            if x < 64 { wall } else { Rgb([2 * x as u8, 4 * y as u8, (x ^ y) as u8]) }
        });
        let palette = palette(std::slice::from_ref(&frame));
        assert_eq!(palette.len(), MOST_COLORS);
        assert!((0..3).all(|c| palette[0][c].abs_diff(wall[c]) <= 7), "{:?}", palette[0]);
        assert_eq!(nearest(&palette, wall.0), 0);
        assert!(film(&[], 100).is_err());
        assert!(film(&[frame, RgbImage::new(1, 1)], 100).is_err());
    }
}
