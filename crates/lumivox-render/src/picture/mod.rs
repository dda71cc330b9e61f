//! Pictures, from radiance to screens and files: `tone_map/` exposes and encodes them, `develop`
//! does the same for radiance from other sources, and [`Picture`] stores and writes the result.

mod develop;
pub(crate) mod srgb;
pub(crate) mod tone_map;

use std::io::{self, Cursor, Seek, Write};
use std::path::Path;

use exr::prelude::{SpecificChannels, WritableImage as _};
use glam::UVec2;
use image::{ExtendedColorType, ImageEncoder as _};
use lumivox::gpu::ShaderLibrary;
use lumivox_scene::write_atomically;

use crate::{RenderError, ToneMap};

/// Defines the numbers of the tone map's curves and encodings.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("ENCODE_COLOR", tone_map::ENCODE_COLOR)
        .constant_u32("ENCODE_DATA", tone_map::ENCODE_DATA)
        .constant_u32("ENCODE_HEAT", tone_map::ENCODE_HEAT)
        .constant_u32("ENCODE_LOG_HEAT", tone_map::ENCODE_LOG_HEAT);
    for curve in ToneMap::ALL {
        library.constant_u32(curve.constant(), curve as u32);
    }
}

/// A finished picture, row by row from the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Picture {
    /// Width and height in pixels.
    pub size: UVec2,
    /// Radiance in cd/m², or the quantity of a view, in rgb; the surfaces' share of the pixel in a.
    pub hdr: Vec<[f32; 4]>,
    /// The pixels for a screen: exposed, tone mapped, sRGB-encoded, opaque.
    pub ldr: Vec<[u8; 4]>,
}

/// A file format for pictures.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ImageFormat {
    /// 8 bits a channel, tone mapped.
    Png,
    /// `OpenEXR`: 32-bit floats, linear, in cd/m² (or the unit of a data view), not exposed.
    Exr,
}

impl ImageFormat {
    /// The format for a file's extension; call it before rendering.
    ///
    /// # Errors
    /// [`RenderError::UnknownFormat`] when it is neither `png` nor `exr`, ignoring case.
    pub fn from_path(path: &Path) -> Result<Self, RenderError> {
        let extension = path.extension().map(|e| e.to_string_lossy().into_owned());
        let extension = extension.unwrap_or_default();
        match extension.to_ascii_lowercase().as_str() {
            "png" => Ok(Self::Png),
            "exr" => Ok(Self::Exr),
            _ => Err(RenderError::UnknownFormat { file: path.to_owned(), extension }),
        }
    }
}

impl Picture {
    /// Writes the picture in the format of the extension.
    ///
    /// The file is first written under a temporary name in the same folder and then renamed: a
    /// reader finds the old picture or the whole new one.
    ///
    /// # Errors
    /// [`RenderError::UnknownFormat`], and [`RenderError::Write`] when the file cannot be written;
    /// then no temporary file is left behind.
    pub fn write(&self, path: &Path) -> Result<(), RenderError> {
        let format = ImageFormat::from_path(path)?;
        let written = write_atomically(path, |out| self.write_to(out, format));
        written.map_err(|error| RenderError::Write {
            file: path.to_owned(),
            reason: error.to_string(),
        })
    }

    /// The bytes of the picture's file.
    ///
    /// # Errors
    /// When the picture is larger than the format allows.
    pub fn encode(&self, format: ImageFormat) -> io::Result<Vec<u8>> {
        let mut bytes = Cursor::new(Vec::new());
        self.write_to(&mut bytes, format)?;
        Ok(bytes.into_inner())
    }

    fn write_to(&self, out: &mut (impl Write + Seek), format: ImageFormat) -> io::Result<()> {
        match format {
            ImageFormat::Png => self.write_png(out),
            ImageFormat::Exr => self.write_exr(out),
        }
    }

    fn write_png(&self, out: &mut impl Write) -> io::Result<()> {
        // No alpha: transparent sky would be a surprise in a picture of a room.
        let rgb: Vec<u8> = self.ldr.iter().flat_map(|[r, g, b, _]| [*r, *g, *b]).collect();
        image::codecs::png::PngEncoder::new(out)
            .write_image(&rgb, self.size.x, self.size.y, ExtendedColorType::Rgb8)
            .map_err(io::Error::other)
    }

    fn write_exr(&self, out: &mut (impl Write + Seek)) -> io::Result<()> {
        let width = self.size.x as usize;
        let channels = SpecificChannels::rgb(|at: exr::math::Vec2<usize>| {
            let [r, g, b, _] = self.hdr[at.y() * width + at.x()];
            (r, g, b)
        });
        let image = exr::image::Image::from_channels((width, self.size.y as usize), channels);
        // Threads would append their blocks of lines in the order in which they finish, so the
        // bytes would differ between runs.
        image.write().non_parallel().to_buffered(out).map_err(io::Error::other)
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn picture() -> Picture {
        let size = UVec2::new(3, 2);
        let hdr = (0..6).map(|i| [i as f32 * 1000.5, 0.25, -1.0, 1.0]).collect();
        let ldr = (0..6).map(|i| [i * 40, 255 - i, 7, 255]).collect();
        Picture { size, hdr, ldr }
    }

    #[test]
    fn writing_a_picture_twice_gives_equal_bytes() {
        let folder = tempfile::tempdir().expect("a folder");
        let size = UVec2::new(64, 400);
        let pixels = 0..size.x * size.y;
        let hdr = pixels.map(|i| [(i % 977) as f32, (i % 13) as f32, 0.5, 1.0]).collect::<Vec<_>>();
        let picture = Picture { size, ldr: vec![[0; 4]; hdr.len()], hdr };
        let file = folder.path().join("a.exr");
        let mut bytes = (0..20).map(|_| {
            picture.write(&file).expect("written");
            fs::read(&file).expect("read")
        });
        let first = bytes.next().expect("a file");
        assert!(bytes.all(|other| other == first), "the order of the lines differs");
    }

    fn names(folder: &Path) -> Vec<String> {
        let entries = fs::read_dir(folder).expect("the folder");
        let names =
            entries.map(|e| e.expect("an entry").file_name().to_string_lossy().into_owned());
        names.collect()
    }

    #[test]
    fn png_stores_display_pixels_and_replaces_the_old_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.PNG");
        fs::write(&path, "an older picture").expect("writable");
        picture().write(&path).expect("written");
        assert_eq!(names(folder.path()), ["picture.PNG"]);
        let bytes = fs::read(&path).expect("readable");
        let decoded = image::load_from_memory(&bytes).expect("a PNG").to_rgb8();
        assert_eq!(decoded.dimensions(), (3, 2));
        let expected: Vec<u8> = picture().ldr.iter().flat_map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(decoded.into_raw(), expected);
    }

    #[test]
    fn exr_holds_the_radiance_to_the_bit() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("picture.exr");
        picture().write(&path).expect("written");
        assert_eq!(names(folder.path()), ["picture.exr"]);
        let read = exr::prelude::read_first_rgba_layer_from_file(
            &path,
            |size, _| (size.width(), vec![[0.0_f32; 3]; size.area()]),
            |(width, pixels), at, (r, g, b, _): (f32, f32, f32, f32)| {
                pixels[at.y() * *width + at.x()] = [r, g, b];
            },
        )
        .expect("an OpenEXR file");
        let pixels = &read.layer_data.channel_data.pixels.1;
        let expected: Vec<[f32; 3]> = picture().hdr.iter().map(|p| [p[0], p[1], p[2]]).collect();
        assert_eq!(*pixels, expected);
    }

    #[test]
    fn a_failed_write_names_the_file_and_leaves_nothing() {
        let folder = tempfile::tempdir().expect("a folder");
        let missing = folder.path().join("missing").join("picture.png");
        let error = picture().write(&missing).expect_err("no such folder");
        assert!(error.to_string().contains("missing"), "{error}");
        // A folder has the picture's name, so the rename at the end fails.
        let blocked = folder.path().join("picture.exr");
        fs::create_dir(&blocked).expect("a folder");
        let error = picture().write(&blocked).expect_err("a folder is in the way");
        assert!(error.to_string().contains("picture.exr"), "{error}");
        assert_eq!(names(folder.path()), ["picture.exr"]);
    }

    #[test]
    fn other_formats_are_refused_by_name() {
        for name in ["picture.jpg", "picture", "png"] {
            let error = ImageFormat::from_path(Path::new(name)).expect_err("not written here");
            let message = error.to_string();
            assert!(message.contains(name) && message.contains(".png"), "{message}");
        }
    }
}
