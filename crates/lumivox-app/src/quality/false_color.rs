//! Pictures of measured light: each reading as a colour, with a labelled scale.

use std::ops::Range;

use glam::UVec2;
use image::codecs::png::PngEncoder;
use image::{ImageError, Rgb, RgbImage};

use super::canvas::{Align, Canvas};

/// Target for the shorter side of the enlarged field, px.
const LEAST_EDGE: u32 = 420;
/// Limit for the longer side of the enlarged field, px.
const MOST_EDGE: u32 = 1600;
const BACKGROUND: Rgb<u8> = Rgb([24, 24, 27]);
const BRIGHT: Rgb<u8> = Rgb([240, 240, 240]);
const DIM: Rgb<u8> = Rgb([178, 178, 184]);

/// Readings of light, for a picture.
#[derive(Clone, Copy, Debug)]
pub struct FalseColor<'a> {
    /// The first line of text.
    pub title: &'a str,
    /// The second line of text.
    pub figures: &'a str,
    /// The readings, row by row from the top.
    pub values: &'a [f32],
    /// Columns and rows.
    pub size: UVec2,
    /// The unit at the scale, such as lux.
    pub unit: &'a str,
    /// The readings at the ends of the scale; `None`: from 0 to the greatest reading.
    pub range: Option<(f32, f32)>,
}

/// The PNG of readings in false colours with a scale.
///
/// # Errors
/// When the picture is too large for the format.
pub fn false_color_png(light: &FalseColor<'_>) -> Result<Vec<u8>, ImageError> {
    let mut bytes = Vec::new();
    false_color(light).write_with_encoder(PngEncoder::new(&mut bytes))?;
    Ok(bytes)
}

/// Draws readings and a scale in the colour map viridis (van der Walt and Smith 2015), whose
/// brightness grows evenly. Readings beyond the scale have the colours of its ends.
fn false_color(light: &FalseColor<'_>) -> RgbImage {
    let (low, high) = light.range.unwrap_or_else(|| {
        let greatest = light.values.iter().copied().filter(|value| value.is_finite());
        (0.0, greatest.fold(0.0, f32::max))
    });
    let high = if high > low { high } else { low + 1.0 };
    let color = |value: f32| {
        let share = f64::from((value - low) / (high - low)).clamp(0.0, 1.0);
        let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(share);
        Rgb([r, g, b])
    };
    let factor = factor(light.size);
    let (width, height) = (light.size.x * factor, light.size.y * factor);
    let text = 15.0_f32;
    let (gap, line) = (14, 22);
    let (bar, labels) = (22, 92);
    let top = 2 * gap + 2 * line;
    let all = (width + 3 * gap + bar + labels).max(480);
    // Even beside a low field, the scale needs height for its labels.
    let bar_height = height.max(140);
    let mut canvas = Canvas::new(all, top + bar_height + gap + line, BACKGROUND);
    canvas.text(light.title, gap, gap, 1.2 * text, Align::Left, BRIGHT);
    canvas.text(light.figures, gap, gap + line + 4, text, Align::Left, DIM);
    let field = RgbImage::from_fn(width, height, |x, y| {
        let cell = (y / factor) as usize * light.size.x as usize + (x / factor) as usize;
        light.values.get(cell).map_or(BACKGROUND, |value| color(*value))
    });
    canvas.put(&field, gap, top);
    let left = 2 * gap + width;
    let at = |y: u32| low + (high - low) * (1.0 - y as f32 / (bar_height - 1) as f32);
    canvas.put(&RgbImage::from_fn(bar, bar_height, |_, y| color(at(y))), left, top);
    for label in labels_of(low..high) {
        let y = ((high - label.0) / (high - low) * (bar_height - 1) as f32).round() as u32;
        canvas.put(&RgbImage::from_pixel(5, 1, BRIGHT), left + bar, top + y);
        let middle = (top + y).saturating_sub((0.55 * text) as u32);
        canvas.text(&label.1, left + bar + 9, middle, text, Align::Left, BRIGHT);
    }
    canvas.text(light.unit, left, top + bar_height + 6, text, Align::Left, BRIGHT);
    canvas.into_image()
}

/// The pixels along a cell's edge.
fn factor(size: UVec2) -> u32 {
    let needed = LEAST_EDGE.div_ceil(size.min_element().max(1));
    needed.min(MOST_EDGE / size.max_element().max(1)).max(1)
}

/// The round values of a scale (6 to 13 if it starts at 0), with their texts. Steps are 1, 2 or 5
/// times a power of ten (Heckbert 1990, "Nice numbers for graph labels", Graphics Gems).
fn labels_of(range: Range<f32>) -> Vec<(f32, String)> {
    let rough = f64::from(range.end - range.start) / 5.0;
    let power = 10.0_f64.powf(rough.log10().floor());
    let step =
        [1.0, 2.0, 5.0].into_iter().rfind(|times| times * power <= rough).unwrap_or(1.0) * power;
    let digits = (-step.log10().floor()).clamp(0.0, 12.0) as usize;
    let first = (f64::from(range.start) / step).ceil() as i64;
    // Include the end itself in spite of rounding.
    let last = (f64::from(range.end) / step * (1.0 + 1e-6)).floor() as i64;
    (first..=last)
        .map(|number| number as f64 * step)
        .map(|value| (value.min(f64::from(range.end)) as f32, format!("{value:.digits$}")))
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(range: Range<f32>) -> Vec<String> {
        labels_of(range).into_iter().map(|(_, text)| text).collect()
    }

    #[test]
    fn labels_are_round() {
        assert_eq!(texts(0.0..500.0), ["0", "100", "200", "300", "400", "500"]);
        assert_eq!(texts(0.0..0.7), ["0.0", "0.1", "0.2", "0.3", "0.4", "0.5", "0.6", "0.7"]);
        assert_eq!(texts(120.0..390.0), ["150", "200", "250", "300", "350"]);
        for end in [1e-6_f32, 0.3, 1.0, 37.0, 99_999.0, 1e9] {
            assert!((4..=11).contains(&texts(0.0..end).len()), "{end}: {:?}", texts(0.0..end));
        }
    }

    #[test]
    fn pixel_colours_match_the_colour_scale() {
        let values = [0.0, 50.0, 100.0, 200.0];
        let size = UVec2::new(2, 2);
        let light = FalseColor {
            title: "a",
            figures: "",
            values: &values,
            size,
            unit: "lux",
            range: Some((0.0, 100.0)),
        };
        let image = false_color(&light);
        let edge = factor(size);
        let at = |column: u32, row: u32| {
            image.get_pixel(14 + edge / 2 + column * edge, 72 + edge / 2 + row * edge).0
        };
        let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(0.5);
        assert_eq!(at(1, 0), [r, g, b]);
        // Readings of 100 and more have the colour at the top of the scale.
        let top = image.get_pixel(14 + 2 * edge + 14 + 3, 72).0;
        assert_eq!((at(0, 1), at(1, 1)), (top, top));
        let bottom = image.get_pixel(14 + 2 * edge + 14 + 3, 72 + 2 * edge - 1).0;
        assert_eq!(at(0, 0), bottom);
    }
}
