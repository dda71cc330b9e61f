//! Image files as texels.

use std::io::Cursor;
use std::path::Path;

use image::{ImageError, ImageFormat, ImageReader, Limits, RgbaImage};

/// The longest edge in texels: what common GPUs take.
const LONGEST_EDGE: u32 = 16_384;
/// Bytes that decoding one image may take: the largest image with 16 bits a channel, and some.
const MOST_DECODER_BYTES: u64 = 3 << 30;

/// Decodes an image of a kind that is told by its first bytes (declared types are often wrong), or
/// else by the name: TGA has no such bytes.
pub(super) fn decode_rgba8(bytes: &[u8], name: &Path) -> Result<RgbaImage, ImageError> {
    let format = image::guess_format(bytes).or_else(|_| ImageFormat::from_path(name))?;
    let mut reader = ImageReader::with_format(Cursor::new(bytes), format);
    let mut limits = Limits::default();
    limits.max_image_width = Some(LONGEST_EDGE);
    limits.max_image_height = Some(LONGEST_EDGE);
    limits.max_alloc = Some(MOST_DECODER_BYTES);
    reader.limits(limits);
    Ok(reader.decode()?.into_rgba8())
}
