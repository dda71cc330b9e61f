//! Pictures of the surroundings from files: Radiance, OpenEXR, and common pictures.
//!
//! The first bytes decide the kind of file. The size in the header is checked before memory is
//! allocated: against a useful maximum, and against the length of the file, since a compressed
//! picture of one colour can claim any size.

use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use image::{DynamicImage, ImageFormat, ImageReader, Limits};

use super::{exr, hdr};
use crate::load::foreign;
use crate::{EnvironmentMap, SceneError, read_regular};

/// The most texels of a map: 16 384 x 8192, 1.5 GiB.
const MOST_TEXELS: u64 = 1 << 27;
/// Texels that any file may claim, however short: 96 MiB.
const FREE_TEXELS: u64 = 1 << 23;
/// Additional texels that a file may claim for each of its bytes; Radiance's compression reaches
/// 16, OpenEXR's 350.
const TEXELS_PER_BYTE: u64 = 512;
/// The most bytes for decoding a common picture: the largest map with 16 bits a channel, and a
/// little more.
const MOST_DECODER_BYTES: u64 = 2 << 30;

/// The fault of a file, and its remedy.
pub(super) struct Fault {
    pub(super) reason: String,
    pub(super) remedy: &'static str,
}

impl Fault {
    pub(super) fn new(reason: impl Into<String>, remedy: &'static str) -> Self {
        Self { reason: reason.into(), remedy }
    }

    /// The fault of bytes that violate their format.
    pub(super) fn broken(reason: impl std::fmt::Display) -> Self {
        Self::new(format!("{reason}"), "export or download it again")
    }
}

impl EnvironmentMap {
    /// Reads a panorama of 360 by 180 degrees (equirectangular, twice as wide as high): Radiance
    /// (`.hdr`, `.pic`), OpenEXR (`.exr`), PNG or JPEG. The first bytes decide the format.
    ///
    /// Radiance files are divided by their `EXPOSURE` and `COLORCORR`; one unit then counts as 1
    /// cd/m². So does one unit of OpenEXR, multiplied by `whiteLuminance` if the file has it. PNG
    /// and JPEG are decoded from sRGB, so that white is 1 cd/m². Scale by
    /// [`Environment::radiance`](crate::Environment::radiance).
    ///
    /// The repairs and assumptions are in [`EnvironmentMap::warnings`] and in the log.
    ///
    /// # Errors
    /// [`SceneError::Read`] when the file cannot be read, [`SceneError::EnvironmentMap`] when it is
    /// of another kind, is broken, or has more than 2^27 texels (16 384 x 8192). Never panics,
    /// whatever the bytes.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, SceneError> {
        let path = path.as_ref();
        let bytes = read_regular(path)
            .map_err(|source| SceneError::Read { file: path.to_owned(), source })?;
        from_bytes(path, &bytes)
    }

    /// As [`EnvironmentMap::load`], for a file in memory. `name` replaces its path in messages and
    /// becomes the map's name.
    ///
    /// # Errors
    /// As [`EnvironmentMap::load`], except for the disk.
    pub fn from_memory(name: &str, bytes: &[u8]) -> Result<Self, SceneError> {
        from_bytes(Path::new(name), bytes)
    }
}

fn from_bytes(path: &Path, bytes: &[u8]) -> Result<EnvironmentMap, SceneError> {
    if let Some(kind) = foreign::what(bytes) {
        return Err(SceneError::OtherKind { file: path.to_owned(), kind });
    }
    let name = path.file_stem().map(|n| n.to_string_lossy().into_owned()).unwrap_or_default();
    let fault = |fault: Fault| SceneError::EnvironmentMap {
        file: path.to_owned(),
        reason: fault.reason,
        remedy: fault.remedy,
    };
    // The decoders are external code: a panic on hostile bytes becomes an ordinary error.
    let decoded = catch_unwind(AssertUnwindSafe(|| decode(bytes)));
    let decoded = decoded.unwrap_or_else(|_| Err(Fault::broken("the decoder gave up on it")));
    let mut map = decoded.map_err(fault)?;
    map.name = name;
    map.repair();
    if u64::from(map.width) != 2 * u64::from(map.height) {
        map.warnings.push(format!(
                "the environment map is {} x {} texels, not twice as wide as high, and is stretched \
                 over all directions; convert cube crosses, mirror balls and parts of a panorama to \
                 a full equirectangular one",
                map.width, map.height
            ));
    }
    for warning in &map.warnings {
        tracing::warn!("{}: {warning}", path.display());
    }
    Ok(map)
}

fn decode(bytes: &[u8]) -> Result<EnvironmentMap, Fault> {
    // Radiance files begin with `#?` and the name of a program.
    if bytes.starts_with(b"#?") {
        return hdr::decode(bytes);
    }
    match image::guess_format(bytes) {
        Ok(ImageFormat::OpenExr) => exr::decode(bytes),
        Ok(format @ (ImageFormat::Png | ImageFormat::Jpeg)) => decode_picture(bytes, format),
        _ => Err(Fault::new(
            "its format is unknown",
            "give a Radiance (.hdr), OpenEXR (.exr), PNG or JPEG panorama",
        )),
    }
}

/// Refuses sizes that a file of this length cannot have.
pub(super) fn check_size(width: u64, height: u64, file_bytes: usize) -> Result<(), Fault> {
    if width == 0 || height == 0 {
        return Err(Fault::broken(format!("its size is {width} x {height} texels")));
    }
    let texels = width.saturating_mul(height);
    if texels > MOST_TEXELS {
        return Err(Fault::new(
            format!("it has {width} x {height} texels, more than 16384 x 8192"),
            "scale it down",
        ));
    }
    let believed = FREE_TEXELS.saturating_add(TEXELS_PER_BYTE.saturating_mul(file_bytes as u64));
    if texels > believed {
        return Err(Fault::broken(format!(
            "it claims {width} x {height} texels in {file_bytes} bytes, more than packing explains"
        )));
    }
    Ok(())
}

/// Decodes a PNG or a JPEG.
fn decode_picture(bytes: &[u8], format: ImageFormat) -> Result<EnvironmentMap, Fault> {
    let reader = || ImageReader::with_format(std::io::Cursor::new(bytes), format);
    let (width, height) = reader().into_dimensions().map_err(Fault::broken)?;
    check_size(width.into(), height.into(), bytes.len())?;
    let mut reader = reader();
    let mut limits = Limits::default();
    limits.max_alloc = Some(MOST_DECODER_BYTES);
    reader.limits(limits);
    let picture = reader.decode().map_err(Fault::broken)?;
    // The table of linear values has one entry per level: 256 for most pictures, 65 536 for others.
    let rgb = if has_16_bits(&picture) {
        linear(picture.into_rgb16().pixels().map(|p| p.0), 65_535)
    } else {
        linear(picture.into_rgb8().pixels().map(|p| p.0.map(u16::from)), 255)
    };
    let warnings = vec![
        "the environment map is a picture for screens (PNG or JPEG): its lights are cut off at \
         white, which counts as 1 cd/m²; prefer Radiance (.hdr) or OpenEXR (.exr)"
            .to_owned(),
    ];
    Ok(EnvironmentMap { width, height, rgb, warnings, ..EnvironmentMap::default() })
}

fn has_16_bits(picture: &DynamicImage) -> bool {
    picture.color().bytes_per_pixel() > picture.color().channel_count()
}

/// Converts sRGB-encoded values to linear ones (IEC 61966-2-1).
fn linear(texels: impl Iterator<Item = [u16; 3]>, most: u16) -> Vec<[f32; 3]> {
    let decode = |value: u16| {
        let encoded = f64::from(value) / f64::from(most);
        let linear = if encoded <= 0.040_45 {
            encoded / 12.92
        } else {
            ((encoded + 0.055) / 1.055).powf(2.4)
        };
        linear as f32
    };
    let table: Vec<f32> = (0..=most).map(decode).collect();
    texels.map(|texel| texel.map(|value| table[usize::from(value)])).collect()
}
