//! Reading pictures: `OpenEXR`, Radiance, PNG, JPEG. The first bytes determine the format.

use std::fmt::Display;
use std::io::Cursor;
use std::path::Path;

use glam::UVec2;
use image::codecs::hdr::HdrDecoder;
use image::{DynamicImage, ImageFormat, ImageReader};
use lumivox_scene::read_regular;

use super::{CompareError, LinearPicture};
use crate::picture::srgb::srgb_decode;

mod exr;

/// The most pixels of a picture: 16 384 x 8192, 1.5 GiB.
const MOST_PIXELS: u64 = 1 << 27;

/// A picture from a file.
#[derive(Clone, Debug, PartialEq)]
pub struct PictureFile {
    /// The picture.
    pub picture: LinearPicture,
    /// The name of its layer; `None` if the file names none.
    pub layer: Option<String>,
}

/// The fault of a file.
enum Fault {
    Content { reason: String, remedy: &'static str },
    Layer { layer: String, known: String },
}

impl Fault {
    fn new(reason: impl Into<String>, remedy: &'static str) -> Self {
        Self::Content { reason: reason.into(), remedy }
    }

    /// The fault of malformed bytes.
    fn broken(reason: impl Display) -> Self {
        Self::new(reason.to_string(), "save or download it again")
    }
}

impl PictureFile {
    /// Reads a picture as linear RGB: `OpenEXR` (.exr), Radiance (.hdr, divided by its `EXPOSURE`
    /// and `COLORCORR`), PNG or JPEG (decoded from sRGB, so that white is 1). Alpha is left out.
    ///
    /// `layer` is the `OpenEXR` layer to read: the name of a part, or the text before the last dot
    /// of its channels' names, as in `full.R`. If it is `None`, the unnamed layer is read, or the
    /// first layer if all have names. It is ignored for files without named layers. Layers with
    /// only luminance (`Y`) are grey.
    ///
    /// # Errors
    /// [`CompareError::Read`] when the file cannot be read, has another format, is broken, or has
    /// more than 2^27 pixels; [`CompareError::Layer`] when it has layers, but none of that name.
    pub fn read(file: &Path, layer: Option<&str>) -> Result<Self, CompareError> {
        let bytes = read_regular(file)
            .map_err(|error| Fault::new(error.to_string(), "check the path and its permissions"));
        bytes.and_then(|bytes| decode(&bytes, layer)).map_err(|fault| match fault {
            Fault::Content { reason, remedy } => {
                CompareError::Read { file: file.to_owned(), reason, remedy }
            }
            Fault::Layer { layer, known } => {
                CompareError::Layer { file: file.to_owned(), layer, known }
            }
        })
    }
}

fn decode(bytes: &[u8], layer: Option<&str>) -> Result<PictureFile, Fault> {
    let picture = match image::guess_format(bytes) {
        Ok(ImageFormat::OpenExr) => return exr::decode(bytes, layer),
        Ok(ImageFormat::Hdr) => decode_radiance(bytes),
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => decode_screen(bytes, format),
        _ => Err(Fault::new(
            "its format is unknown",
            "give an OpenEXR (.exr), Radiance (.hdr), PNG or JPEG picture",
        )),
    };
    Ok(PictureFile { picture: picture?, layer: None })
}

fn check_size(width: u64, height: u64) -> Result<(), Fault> {
    if width.saturating_mul(height) <= MOST_PIXELS {
        return Ok(());
    }
    let reason = format!("it has {width} x {height} pixels, more than 16384 x 8192");
    Err(Fault::new(reason, "scale it down"))
}

fn linear_picture(image: DynamicImage, decode: impl Fn(f32) -> f32) -> LinearPicture {
    let image = image.into_rgb32f();
    let size = UVec2::from(image.dimensions());
    LinearPicture { size, rgb: image.pixels().map(|pixel| pixel.0.map(&decode)).collect() }
}

/// PNG and JPEG pictures.
fn decode_screen(bytes: &[u8], format: ImageFormat) -> Result<LinearPicture, Fault> {
    let reader = || ImageReader::with_format(Cursor::new(bytes), format);
    let (width, height) = reader().into_dimensions().map_err(Fault::broken)?;
    check_size(width.into(), height.into())?;
    Ok(linear_picture(reader().decode().map_err(Fault::broken)?, srgb_decode))
}

/// Radiance pictures (Ward 1991, "Real pixels", Graphics Gems II).
fn decode_radiance(bytes: &[u8]) -> Result<LinearPicture, Fault> {
    // The strict mode would refuse the signature `#?RGBE`, which many programs write.
    let decoder = HdrDecoder::new_nonstrict(Cursor::new(bytes)).map_err(Fault::broken)?;
    let meta = decoder.metadata();
    check_size(meta.width.into(), meta.height.into())?;
    // The factor by which the pixels were multiplied; dividing by it restores radiances.
    let exposure = meta.exposure.unwrap_or(1.0);
    let (r, g, b) = meta.color_correction.unwrap_or((1.0, 1.0, 1.0));
    let factors = [r, g, b].map(|correction| correction * exposure);
    if factors.iter().any(|factor| !factor.is_normal() || *factor < 0.0) {
        return Err(Fault::broken("its EXPOSURE or COLORCORR is not a positive number"));
    }
    let image = DynamicImage::from_decoder(decoder).map_err(Fault::broken)?;
    let mut picture = linear_picture(image, |value| value);
    for pixel in &mut picture.rgb {
        *pixel = std::array::from_fn(|channel| pixel[channel] / factors[channel]);
    }
    Ok(picture)
}

#[cfg(test)]
mod tests;
