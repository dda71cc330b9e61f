//! Strips of pictures: the reference, ours, and where ours is too dark or too bright.

use std::io;
use std::path::Path;

use image::codecs::png::PngEncoder;
use image::{Rgb, RgbImage, imageops};
use lumivox_console::{Failure, named_figures};
use lumivox_render::compare::{CompareError, ErrorFigures, LinearPicture, relative_errors};
use lumivox_scene::write_atomically;

use super::canvas::{Align, Canvas};

/// The relative error at the ends of the colour scale; larger errors have the colour of the end.
const SCALE_END: f64 = 0.5;

/// Target width of enlarged small pictures, px, so that the text beside them is readable.
const LEAST_WIDTH: u32 = 360;
/// The greatest height of an enlarged picture, in pixels.
const MOST_ENLARGED_HEIGHT: u32 = 1440;

const BACKGROUND: Rgb<u8> = Rgb([24, 24, 27]);
const BRIGHT: Rgb<u8> = Rgb([240, 240, 240]);
const DIM: Rgb<u8> = Rgb([178, 178, 184]);

/// One comparison in a strip.
#[derive(Clone, Copy, Debug)]
pub struct Row<'a> {
    /// Its name.
    pub label: &'a str,
    /// The reference.
    pub reference: &'a LinearPicture,
    /// The picture that is compared with it.
    pub ours: &'a LinearPicture,
    /// Its errors.
    pub figures: &'a ErrorFigures,
}

/// Draws a row for each comparison: the reference, ours, and the signed error as colours.
///
/// Both pictures of a row have the automatic exposure of its reference and the curve
/// [`Neutral`](lumivox_render::ToneMap::Neutral). [`relative_errors`] gives the errors. Small
/// pictures are enlarged by an integer factor.
///
/// # Errors
/// As [`relative_errors`].
pub fn strip(title: &str, rows: &[Row<'_>]) -> Result<RgbImage, CompareError> {
    let layout = Layout::new(rows);
    let mut canvas = Canvas::new(layout.width, layout.height(rows), BACKGROUND);
    let (gap, line) = (layout.gap, layout.line());
    canvas.text(title, gap, gap, 1.25 * layout.text, Align::Left, BRIGHT);
    let mut y = 2 * gap + line;
    for row in rows {
        layout.draw_row(&mut canvas, y, row)?;
        y += layout.row_height(row);
    }
    layout.draw_scale(&mut canvas, y);
    Ok(canvas.into_image())
}

/// Sizes in pixels. Text and gaps grow with the pictures.
struct Layout {
    /// Width of each of the three columns.
    column: u32,
    width: u32,
    gap: u32,
    /// The height of a line of text.
    text: f32,
}

impl Layout {
    fn new(rows: &[Row<'_>]) -> Self {
        let widths = rows.iter().map(|row| row.reference.size.x * factor(row.reference));
        let column = widths.max().unwrap_or(0).max(LEAST_WIDTH);
        let text = column as f32 / 22.0;
        let gap = (0.75 * text).round() as u32;
        Self { column, width: 3 * column + 4 * gap, gap, text }
    }

    /// The distance between two lines of text.
    fn line(&self) -> u32 {
        (1.4 * self.text).round() as u32
    }

    fn row_height(&self, row: &Row<'_>) -> u32 {
        2 * self.line() + row.reference.size.y * factor(row.reference) + self.gap
    }

    fn height(&self, rows: &[Row<'_>]) -> u32 {
        let rows: u32 = rows.iter().map(|row| self.row_height(row)).sum();
        2 * self.gap + self.line() + rows + 12 * self.line() / 5 + self.gap
    }

    fn left(&self, column: u32) -> u32 {
        self.gap + column * (self.column + self.gap)
    }

    fn draw_row(&self, canvas: &mut Canvas, y: u32, row: &Row<'_>) -> Result<(), CompareError> {
        canvas.text(row.label, self.left(0), y, self.text, Align::Left, BRIGHT);
        let known = named_figures(row.figures).into_iter();
        let known = known.filter_map(|(name, value)| Some(format!("{name} {}", value?)));
        let figures = known.collect::<Vec<_>>().join("     ");
        canvas.text(&figures, self.width - self.gap, y, self.text, Align::Right, BRIGHT);

        let stops = row.reference.exposure_stops();
        let errors = relative_errors(row.reference, row.ours)?;
        let panels = [
            ("reference", row.reference.to_screen(stops)),
            ("ours", row.ours.to_screen(stops)),
            ("error: blue too dark, red too bright", errors.into_iter().map(color).collect()),
        ];
        for (column, (caption, pixels)) in (0..).zip(panels) {
            let x = self.left(column);
            let y = y + self.line();
            canvas.text(caption, x, y, 0.85 * self.text, Align::Left, DIM);
            canvas.put(&enlarged(&pixels, row.reference), x, y + self.line());
        }
        Ok(())
    }

    /// Draws the scale of errors, below their column.
    fn draw_scale(&self, canvas: &mut Canvas, y: u32) {
        let small = 0.85 * self.text;
        let (x, width) = (self.left(2), self.column);
        let error_at = |x: u32| SCALE_END * (2.0 * f64::from(x) / f64::from(width - 1) - 1.0);
        let bar = RgbImage::from_fn(width, self.line() / 2, |x, _| Rgb(color(error_at(x))));
        canvas.put(&bar, x, y);
        let (below, end) = (y + self.line() / 2 + self.gap / 4, 100.0 * SCALE_END);
        for (at, text, align) in [
            (0, format!("-{end} % or darker"), Align::Left),
            (width / 2, "0 %".to_owned(), Align::Center),
            (width, format!("+{end} % or brighter"), Align::Right),
        ] {
            canvas.text(&text, x + at, below, small, align, DIM);
        }
        for (line, text) in [
            "Both pictures with the automatic exposure of the reference.",
            "Error: luminance of ours less that of the reference, as a share of the reference",
            "(of a tenth of its mean where it is darker than that).",
        ]
        .into_iter()
        .enumerate()
        {
            let y = y + line as u32 * 4 * self.line() / 5;
            canvas.text(text, self.gap, y, small, Align::Left, DIM);
        }
    }
}

/// Writes a strip as PNG, complete or not at all.
///
/// # Errors
/// A [`Failure`] of output that names the file.
pub fn write_strip(file: &Path, image: &RgbImage) -> anyhow::Result<()> {
    let written = write_atomically(file, |out| {
        image.write_with_encoder(PngEncoder::new(out)).map_err(io::Error::other)
    });
    let failure = |error| format!("{}: cannot write the strip: {error}", file.display());
    written.map_err(|error| {
        Failure::output(failure(error) + "; check the folder and its permissions").into()
    })
}

/// The integer factor by which a picture is enlarged.
fn factor(picture: &LinearPicture) -> u32 {
    let [width, height] = picture.size.to_array().map(|edge| edge.max(1));
    LEAST_WIDTH.div_ceil(width).min(MOST_ENLARGED_HEIGHT / height).max(1)
}

fn enlarged(pixels: &[[u8; 3]], picture: &LinearPicture) -> RgbImage {
    let [width, height] = picture.size.to_array();
    let image = RgbImage::from_fn(width, height, |x, y| Rgb(pixels[(y * width + x) as usize]));
    let factor = factor(picture);
    imageops::resize(&image, width * factor, height * factor, imageops::FilterType::Nearest)
}

/// The colour of an error: blue is too dark, near white is right, red is too bright (Brewer 2003,
/// the scheme red to blue).
fn color(error: f64) -> [u8; 3] {
    let share = (error / SCALE_END).clamp(-1.0, 1.0);
    let color = colorous::RED_BLUE.eval_continuous(0.5 - 0.5 * share);
    [color.r, color.g, color.b]
}

#[cfg(test)]
mod tests {
    use glam::UVec2;

    use super::*;

    fn picture(size: UVec2, value: impl Fn(u32) -> f32) -> LinearPicture {
        LinearPicture { size, rgb: (0..size.x * size.y).map(|i| [value(i); 3]).collect() }
    }

    fn drawn(rows: &[(&LinearPicture, &LinearPicture)]) -> RgbImage {
        let figures: Vec<_> =
            rows.iter().map(|(r, x)| ErrorFigures::new(r, None, x).unwrap()).collect();
        let rows: Vec<_> = rows
            .iter()
            .zip(&figures)
            .map(|((reference, ours), figures)| Row { label: "all", reference, ours, figures })
            .collect();
        strip("a title", &rows).unwrap()
    }

    #[test]
    fn error_colors_show_too_dark_and_too_bright() {
        let [[low, _, low_blue], [high, _, high_blue]] = [color(-0.2), color(0.2)];
        assert!(low < low_blue && high > high_blue);
        assert!(color(0.0).iter().all(|&channel| channel > 230), "{:?}", color(0.0));
        assert_eq!(color(SCALE_END), color(9.0));
        assert_ne!(color(SCALE_END), color(0.9 * SCALE_END));
        assert_eq!(color(-SCALE_END), color(-9.0));
    }

    #[test]
    fn the_strip_shows_reference_ours_and_error() {
        // Three pixels: correct, too dark by half, too bright by half.
        let size = UVec2::new(3, 1);
        let reference = picture(size, |_| 2.0);
        let ours = picture(size, |i| [2.0, 1.0, 3.0][i as usize]);
        let image = drawn(&[(&reference, &ours)]);
        let layout = Layout { column: 360, width: image.width(), gap: 12, text: 360.0 / 22.0 };
        // The middle of a pixel that is enlarged 120 times.
        let y = 2 * layout.gap + 3 * layout.line() + 60;
        let at =
            |column: u32, pixel: u32| image.get_pixel(layout.left(column) + 120 * pixel + 60, y).0;
        let shown = reference.to_screen(reference.exposure_stops())[0];
        assert_eq!([at(0, 0), at(0, 1), at(0, 2), at(1, 0)], [shown; 4]);
        assert!(at(1, 1)[0] < shown[0] && at(1, 2)[0] > shown[0]);
        assert_eq!([at(2, 0), at(2, 1), at(2, 2)], [color(0.0), color(-0.5), color(0.5)]);
    }

    #[test]
    fn the_strip_grows_to_fit_every_row() {
        let [small, large] = [UVec2::new(8, 6), UVec2::new(500, 300)].map(|s| picture(s, |_| 1.0));
        let one = drawn(&[(&small, &small)]);
        let two = drawn(&[(&small, &small), (&large, &large)]);
        // The title and the label of the first row are drawn.
        for image in [&one, &two] {
            let gap = (0.75 * (image.width() as f32 / 3.0) / 22.0) as u32;
            for top in [gap / 2, 3 * gap] {
                let line =
                    (0..image.width()).flat_map(|x| (top..top + 2 * gap).map(move |y| (x, y)));
                let ink = line.filter(|&(x, y)| *image.get_pixel(x, y) != BACKGROUND).count();
                assert!(ink > 50, "{ink} pixels at {top} of {}x{}", image.width(), image.height());
            }
        }
        assert!(two.width() > 3 * 500 && two.height() > 300 + 6 * factor(&small));
    }

    #[test]
    fn only_small_pictures_are_enlarged() {
        let of = |width, height| factor(&picture(UVec2::new(width, height), |_| 0.0));
        assert_eq!(of(96, 72), 4);
        assert_eq!(of(320, 240), 2);
        assert_eq!(of(640, 360), 1);
        assert_eq!(of(1, 1000), 1);
        assert_eq!(of(1, 1), 360);
    }
}
