//! Image files of any format: their size without decoding, and their texels.
//!
//! The first bytes decide the format, since declared types are often wrong; Targa, which has no
//! signature, is recognized by the file's extension, or by a plausible header. KTX2 needs the
//! feature `gltf`. A size for which the file is too short is refused before memory is allocated: a
//! few bytes can claim a gigabyte.

mod board;
#[cfg(feature = "gltf")]
mod ktx2;
mod shrink;

use std::borrow::Cow;
use std::io::{BufRead, BufReader, Cursor, Read, Seek};
use std::path::{Path, PathBuf};

use image::{ImageFormat, ImageReader, Limits};

use super::foreign;
use super::regular::{open_regular, read_regular};

pub(super) use board::{BOARD_EDGE, board, checker};
pub(super) use shrink::{Encoding, halved, shrink};

/// The longest edge in texels: the limit of common GPUs.
const LONGEST_EDGE: u32 = 16_384;
/// The most bytes for decoding one image: the largest image with 16 bits a channel, and a little
/// more.
const MOST_DECODER_BYTES: u64 = 3 << 30;
/// Texels that any file may have, however short: 16 MiB as RGBA.
const FREE_TEXELS: u64 = 4 << 20;
/// Additional texels for each byte of the file. Deflate reaches 1032 bytes a byte (RFC 1951: 258
/// bytes from two bits), and a byte of a one-bit PNG holds eight texels; other formats stay below
/// that in real pictures.
const MOST_TEXELS_A_BYTE: u64 = 16_384;

/// The last chunk of a PNG file.
const PNG_END: &[u8] = b"\0\0\0\0IEND\xae\x42\x60\x82";

/// The bytes that are read to detect a format and its size; KTX2's header is the longest.
const START_BYTES: usize = 80;

/// The source of an image's bytes.
#[derive(Clone, Debug)]
pub(super) enum Source<'a> {
    /// In memory.
    Memory(Cow<'a, [u8]>),
    /// A separate file, only read for decoding.
    File(PathBuf),
}

impl Source<'_> {
    /// Reads all bytes.
    fn read(&self) -> Result<Cow<'_, [u8]>, Fault> {
        match self {
            Self::Memory(bytes) => Ok(Cow::Borrowed(bytes)),
            Self::File(path) => read_regular(path).map(Cow::Owned).map_err(Fault::Unreadable),
        }
    }
}

/// The format and size of an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    format: Format,
    /// Width in texels, at least 1.
    pub(super) width: u32,
    /// Height in texels, at least 1.
    pub(super) height: u32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Format {
    /// The formats that the `image` crate decodes.
    Plain(ImageFormat),
    #[cfg(feature = "gltf")]
    Ktx2,
}

/// Texels: red, green, blue, alpha, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) struct Pixels {
    pub(super) width: u32,
    pub(super) height: u32,
    pub(super) rgba8: Vec<u8>,
}

/// The reason why an image cannot be used.
#[derive(Debug)]
pub(super) enum Fault {
    /// The file cannot be read.
    Unreadable(std::io::Error),
    /// The content is broken or of an unsupported kind: the reason and the remedy.
    Bad(String, &'static str),
    /// The content is not an image: its kind and the remedy.
    OtherKind(&'static str),
}

/// The remedy if the bytes violate their format.
const BROKEN: &str = "export it or download it again";
/// The remedy if the bytes are valid, but the format is not supported.
const OF_ANOTHER_KIND: &str = "save it as a plain PNG or JPEG";
/// The remedy against too many texels.
const LARGE: &str = "scale it down";

impl std::fmt::Display for Fault {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Unreadable(error) => write!(f, "{error}"),
            Self::Bad(reason, remedy) => write!(f, "{reason}; {remedy}"),
            Self::OtherKind(kind) => write!(f, "{kind}"),
        }
    }
}

impl From<image::ImageError> for Fault {
    fn from(error: image::ImageError) -> Self {
        if let image::ImageError::IoError(error) = &error
            && error.kind() == std::io::ErrorKind::UnexpectedEof
        {
            return Self::Bad("it was cut off".to_owned(), BROKEN);
        }
        let remedy = match &error {
            image::ImageError::Unsupported(_) => OF_ANOTHER_KIND,
            image::ImageError::Limits(_) => LARGE,
            _ => BROKEN,
        };
        Self::Bad(error.to_string(), remedy)
    }
}

/// Reads the size of an image; only the beginning of a file is read.
pub(super) fn header(source: &Source<'_>) -> Result<Header, Fault> {
    match source {
        Source::Memory(bytes) => header_of(Cursor::new(bytes.as_ref()), bytes.len() as u64, None),
        Source::File(path) => {
            let (file, length) = open_regular(path).map_err(Fault::Unreadable)?;
            header_of(BufReader::new(file), length, Some(path))
        }
    }
}

/// Decodes an image to 8 bits a channel. An image without alpha is opaque; grey becomes red, green
/// and blue.
pub(super) fn decode(source: &Source<'_>, header: Header) -> Result<Pixels, Fault> {
    let bytes = source.read()?;
    let pixels = match header.format {
        #[cfg(feature = "gltf")]
        Format::Ktx2 => ktx2::decode(&bytes).map_err(of_ktx2)?,
        Format::Plain(format) => {
            let mut image = reader(Cursor::new(bytes.as_ref()), format).decode();
            if image.is_err() && format == ImageFormat::Png {
                // Perhaps only the last chunk is missing, and all texels are present.
                let bytes = [bytes.as_ref(), PNG_END].concat();
                image = reader(Cursor::new(bytes), format).decode().or(image);
            }
            let image = image?.into_rgba8();
            Pixels { width: image.width(), height: image.height(), rgba8: image.into_raw() }
        }
    };
    // The budget was computed for the header's size; the file may have changed since.
    if (pixels.width, pixels.height) != (header.width, header.height) {
        let reason = "its size changed while it was read".to_owned();
        return Err(Fault::Bad(reason, "open the scene again"));
    }
    Ok(pixels)
}

/// Decodes the bytes of the file at `path`.
pub(super) fn decode_file(bytes: &[u8], path: &Path) -> Result<Pixels, Fault> {
    let header = header_of(Cursor::new(bytes), bytes.len() as u64, Some(path))?;
    decode(&Source::Memory(Cow::Borrowed(bytes)), header)
}

/// The fault of a KTX2 file that is broken or of an unsupported kind; another format helps in both
/// cases.
#[cfg(feature = "gltf")]
fn of_ktx2(reason: String) -> Fault {
    Fault::Bad(reason, OF_ANOTHER_KIND)
}

fn header_of(
    mut input: impl BufRead + Seek,
    length: u64,
    path: Option<&Path>,
) -> Result<Header, Fault> {
    let mut start = Vec::with_capacity(START_BYTES);
    input.by_ref().take(START_BYTES as u64).read_to_end(&mut start).map_err(Fault::Unreadable)?;
    input.rewind().map_err(Fault::Unreadable)?;
    if start.is_empty() {
        return Err(Fault::Bad("it is empty".to_owned(), BROKEN));
    }
    let (format, width, height) = match &start {
        #[cfg(feature = "gltf")]
        start if ktx2::is_ktx2(start) => {
            let (width, height) = ktx2::size(start).map_err(of_ktx2)?;
            (Format::Ktx2, width, height)
        }
        start => {
            let format = plain_format(start, path)?;
            let (width, height) = reader(input, format).into_dimensions()?;
            (Format::Plain(format), width, height)
        }
    };
    if width == 0 || height == 0 {
        return Err(Fault::Bad(format!("it has {width} x {height} texels"), BROKEN));
    }
    if width > LONGEST_EDGE || height > LONGEST_EDGE {
        let reason =
            format!("it has {width} x {height} texels, more than {LONGEST_EDGE} along an edge");
        return Err(Fault::Bad(reason, LARGE));
    }
    let texels = u64::from(width) * u64::from(height);
    if texels > FREE_TEXELS.saturating_add(length.saturating_mul(MOST_TEXELS_A_BYTE)) {
        let reason =
            format!("it claims {width} x {height} texels, which its {length} bytes cannot hold");
        return Err(Fault::Bad(reason, BROKEN));
    }
    Ok(Header { format, width, height })
}

fn plain_format(start: &[u8], path: Option<&Path>) -> Result<ImageFormat, Fault> {
    let is_targa = || path.and_then(Path::extension).is_some_and(|e| e.eq_ignore_ascii_case("tga"));
    let format = match image::guess_format(start) {
        Ok(format) => format,
        Err(_) if is_targa() || has_targa_header(start) => ImageFormat::Tga,
        Err(error) => {
            return Err(foreign::what(start).map_or_else(|| error.into(), Fault::OtherKind));
        }
    };
    if format.reading_enabled() {
        return Ok(format);
    }
    let reason = format!("the format {} is not read", format.extensions_str()[0]);
    Err(Fault::Bad(reason, OF_ANOTHER_KIND))
}

/// Whether the bytes begin with a plausible header of Targa: colour map, kind of texels, and bits.
fn has_targa_header(start: &[u8]) -> bool {
    let kind = start.get(1).zip(start.get(2));
    matches!(kind, Some((0, 2 | 3 | 10 | 11) | (1, 1 | 9)))
        && matches!(start.get(16), Some(8 | 15 | 16 | 24 | 32))
}

fn reader<R: BufRead + Seek>(input: R, format: ImageFormat) -> ImageReader<R> {
    let mut reader = ImageReader::with_format(input, format);
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_DECODER_BYTES);
    reader.limits(limits);
    reader
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory(bytes: &[u8]) -> Source<'_> {
        Source::Memory(Cow::Borrowed(bytes))
    }

    fn encode(image: &image::DynamicImage, format: ImageFormat) -> Vec<u8> {
        let mut bytes = Cursor::new(Vec::new());
        image.write_to(&mut bytes, format).unwrap();
        bytes.into_inner()
    }

    #[test]
    fn image_formats_are_detected_by_first_bytes() {
        let image = image::RgbaImage::from_fn(3, 2, |x, y| {
            image::Rgba([x as u8 * 80, y as u8 * 90, 7, 200 + x as u8])
        });
        let image = image::DynamicImage::from(image);
        for format in [ImageFormat::Png, ImageFormat::WebP, ImageFormat::Tga] {
            let mut bytes = encode(&image, format);
            if format == ImageFormat::Png {
                bytes.truncate(bytes.len() - PNG_END.len());
            }
            let header = header(&memory(&bytes)).unwrap();
            assert_eq!((header.width, header.height), (3, 2));
            let pixels = decode(&memory(&bytes), header).unwrap();
            assert_eq!(pixels.rgba8, image.to_rgba8().into_raw(), "{format:?}");
        }
        let deep = image::ImageBuffer::from_pixel(2, 1, image::Luma([0x80ff_u16]));
        let bytes = encode(&deep.into(), ImageFormat::Png);
        let pixels = decode(&memory(&bytes), header(&memory(&bytes)).unwrap()).unwrap();
        assert_eq!(pixels.rgba8, [128, 128, 128, 255, 128, 128, 128, 255]);
    }

    #[test]
    fn a_size_that_the_file_cannot_hold_is_refused_before_it_is_decoded() {
        // Only the header of a PNG of 16384 x 16384 texels, with a correct checksum.
        let large = image::GrayImage::new(16_384, 1);
        let mut bytes = encode(&large.into(), ImageFormat::Png);
        bytes[20..24].copy_from_slice(&16_384_u32.to_be_bytes());
        let crc = bytes[12..29].iter().fold(u32::MAX, |crc, &byte| {
            (0..8).fold(crc ^ u32::from(byte), |crc, _| {
                if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 }
            })
        });
        bytes[29..33].copy_from_slice(&(!crc).to_be_bytes());
        assert!(bytes.len() < 1000);
        let fault = header(&memory(&bytes)).unwrap_err().to_string();
        assert!(fault.contains("cannot hold") && fault.contains("16384"), "{fault}");
    }

    #[test]
    fn errors_say_why_data_is_not_an_image() {
        for (bytes, remedy) in [
            (&b""[..], BROKEN),
            (b"hello", OF_ANOTHER_KIND),
            (b"GIF89a no picture", OF_ANOTHER_KIND),
            // Saving it as a PNG is no remedy for a broken PNG.
            (b"\x89PNG\r\n\x1a\n", BROKEN),
        ] {
            let fault = header(&memory(bytes)).unwrap_err().to_string();
            assert!(fault.ends_with(&format!("; {remedy}")), "{fault}");
        }
        let missing = Source::File(PathBuf::from("/nowhere/at/all.png"));
        assert!(matches!(header(&missing), Err(Fault::Unreadable(_))));
    }
}
