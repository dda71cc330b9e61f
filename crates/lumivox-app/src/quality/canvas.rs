//! A picture on which rectangles, pictures and text are drawn.

use ab_glyph::{Font as _, FontRef, Glyph, Point, PxScale, ScaleFont as _, point};
use image::{Rgb, RgbImage, imageops};

/// The alignment of text at a position.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Align {
    /// Text begins at the position.
    Left,
    /// Text is centred at the position.
    Center,
    /// Text ends at the position.
    Right,
}

/// A picture to draw on.
pub struct Canvas {
    image: RgbImage,
    font: FontRef<'static>,
}

impl Canvas {
    /// A canvas of one colour.
    pub fn new(width: u32, height: u32, color: Rgb<u8>) -> Self {
        let font = FontRef::try_from_slice(epaint_default_fonts::UBUNTU_LIGHT);
        let font = font.unwrap_or_else(|_| unreachable!("the font that is built in is sound"));
        Self { image: RgbImage::from_pixel(width, height, color), font }
    }

    /// The finished picture.
    pub fn into_image(self) -> RgbImage {
        self.image
    }

    /// Draws a picture at a place in pixels from the top left; parts outside are cut off.
    pub fn put(&mut self, picture: &RgbImage, x: u32, y: u32) {
        imageops::replace(&mut self.image, picture, x.into(), y.into());
    }

    /// Draws a line of text with a height of `size` pixels, its top at `y` and aligned at `x`.
    pub fn text(&mut self, text: &str, x: u32, y: u32, size: f32, align: Align, color: Rgb<u8>) {
        let width = self.text_width(text, size);
        let left = match align {
            Align::Left => 0.0,
            Align::Center => 0.5 * width,
            Align::Right => width,
        };
        let top_left = point(x as f32 - left, y as f32);
        for glyph in self.layout(text, size, top_left).0 {
            let Some(outline) = self.font.outline_glyph(glyph) else { continue };
            let bounds = outline.px_bounds();
            let image = &mut self.image;
            outline.draw(|x, y, coverage| {
                let (x, y) =
                    (bounds.min.x as i64 + i64::from(x), bounds.min.y as i64 + i64::from(y));
                let (Ok(x), Ok(y)) = (u32::try_from(x), u32::try_from(y)) else { return };
                if let Some(pixel) = image.get_pixel_mut_checked(x, y) {
                    for (below, &ink) in pixel.0.iter_mut().zip(&color.0) {
                        let mixed =
                            f32::from(*below) * (1.0 - coverage) + f32::from(ink) * coverage;
                        *below = mixed.round() as u8;
                    }
                }
            });
        }
    }

    /// The width of a line of text with a height of `size` pixels.
    pub fn text_width(&self, text: &str, size: f32) -> f32 {
        self.layout(text, size, Point::default()).1
    }

    /// The glyphs of a line, and its width.
    fn layout(&self, text: &str, size: f32, top_left: Point) -> (Vec<Glyph>, f32) {
        let font = self.font.as_scaled(PxScale::from(size));
        let mut glyphs: Vec<Glyph> = Vec::new();
        let mut x = 0.0;
        for character in text.chars() {
            let id = font.glyph_id(character);
            if let Some(last) = glyphs.last() {
                x += font.kern(last.id, id);
            }
            let place = top_left + point(x, font.ascent());
            glyphs.push(id.with_scale_and_position(size, place));
            x += font.h_advance(id);
        }
        (glyphs, x)
    }
}
