//! KTX 2.0 (Khronos, "KTX File Format Specification 2.0"): the container of compressed textures.
//!
//! Only the finest level of one face and layer is read. Basis Universal (ETC1S, UASTC) and ASTC are
//! decoded by `basisu`, the older block formats by `texture2ddecoder`; both were chosen for their
//! behaviour with broken files. A decoder that does not check the container carefully gets a new
//! container of checked data.

use std::borrow::Cow;
use std::io::Read;

use ktx2::{Format, Header, LevelIndex, SupercompressionScheme};
use ruzstd::decoding::StreamingDecoder;

use super::Pixels;

/// Bytes of the header.
const HEADER_BYTES: usize = Header::LENGTH;
/// The largest decoding window: `zstd`'s decoder buffers as much as the file asks for, up to this.
const LARGEST_WINDOW_BYTES: u64 = 128 << 20;

pub(super) fn is_ktx2(start: &[u8]) -> bool {
    start.starts_with(&ktx2::MAGIC)
}

/// The size in the header, if the image is of a supported kind.
pub(super) fn size(start: &[u8]) -> Result<(u32, u32), String> {
    let header = header(start)?;
    if header.pixel_depth > 1 || header.face_count != 1 || header.layer_count > 1 {
        return Err("it is a volume, a cube or an array, but one flat image is wanted".to_owned());
    }
    kind(&header)?;
    Ok((header.pixel_width, header.pixel_height.max(1)))
}

pub(super) fn decode(bytes: &[u8]) -> Result<Pixels, String> {
    let (width, height) = size(bytes)?;
    let header = header(bytes)?;
    let kind = kind(&header)?;
    let level = finest_level(bytes)?;
    let texels = width as usize * height as usize;
    let rgba8 = match kind {
        Kind::Channels(channels) => {
            let bytes_a_texel = channels.iter().flatten().count();
            let data = inflate(bytes, &header, &level, texels * bytes_a_texel)?;
            data.chunks_exact(bytes_a_texel)
                .flat_map(|texel| {
                    let value = |c: usize| match channels[c] {
                        Some(at) => texel[at],
                        None if c == 3 => 255,
                        None => 0,
                    };
                    [value(0), value(1), value(2), value(3)]
                })
                .collect()
        }
        Kind::Blocks { bytes: block, decode } => {
            let blocks = width.div_ceil(4) as usize * height.div_ceil(4) as usize;
            let data = inflate(bytes, &header, &level, blocks * block)?;
            let mut bgra = vec![0_u32; texels];
            decode(&data, width as usize, height as usize, &mut bgra)?;
            bgra.into_iter()
                .flat_map(|texel| {
                    let [b, g, r, a] = texel.to_le_bytes();
                    [r, g, b, a]
                })
                .collect()
        }
        Kind::Basis => decode_basis(bytes, &header, &level)?,
    };
    if rgba8.len() != texels * 4 {
        return Err("its finest level does not have the declared size".to_owned());
    }
    Ok(Pixels { width, height, rgba8 })
}

type BlockDecoder = fn(&[u8], usize, usize, &mut [u32]) -> Result<(), &'static str>;

/// The decoding of a format.
enum Kind {
    /// Bytes; the positions of red, green, blue and alpha in a texel.
    Channels([Option<usize>; 4]),
    /// Blocks of 4 x 4 texels.
    Blocks { bytes: usize, decode: BlockDecoder },
    /// Basis Universal or ASTC.
    Basis,
}

fn kind(header: &Header) -> Result<Kind, String> {
    use texture2ddecoder as blocks;
    let block = |bytes: usize, decode: BlockDecoder| Kind::Blocks { bytes, decode };
    let Some(format) = header.format else { return Ok(Kind::Basis) };
    Ok(match format {
        Format::R8_UNORM | Format::R8_SRGB => Kind::Channels([Some(0), None, None, None]),
        Format::R8G8_UNORM | Format::R8G8_SRGB => Kind::Channels([Some(0), Some(1), None, None]),
        Format::R8G8B8_UNORM | Format::R8G8B8_SRGB => {
            Kind::Channels([Some(0), Some(1), Some(2), None])
        }
        Format::B8G8R8_UNORM | Format::B8G8R8_SRGB => {
            Kind::Channels([Some(2), Some(1), Some(0), None])
        }
        Format::R8G8B8A8_UNORM | Format::R8G8B8A8_SRGB => {
            Kind::Channels([Some(0), Some(1), Some(2), Some(3)])
        }
        Format::B8G8R8A8_UNORM | Format::B8G8R8A8_SRGB => {
            Kind::Channels([Some(2), Some(1), Some(0), Some(3)])
        }
        Format::BC1_RGB_UNORM_BLOCK | Format::BC1_RGB_SRGB_BLOCK => block(8, blocks::decode_bc1),
        Format::BC1_RGBA_UNORM_BLOCK | Format::BC1_RGBA_SRGB_BLOCK => block(8, blocks::decode_bc1a),
        Format::BC2_UNORM_BLOCK | Format::BC2_SRGB_BLOCK => block(16, blocks::decode_bc2),
        Format::BC3_UNORM_BLOCK | Format::BC3_SRGB_BLOCK => block(16, blocks::decode_bc3),
        Format::BC4_UNORM_BLOCK => block(8, blocks::decode_bc4),
        Format::BC5_UNORM_BLOCK => block(16, blocks::decode_bc5),
        Format::BC7_UNORM_BLOCK | Format::BC7_SRGB_BLOCK => block(16, blocks::decode_bc7),
        Format::ETC2_R8G8B8_UNORM_BLOCK | Format::ETC2_R8G8B8_SRGB_BLOCK => {
            block(8, blocks::decode_etc2_rgb)
        }
        Format::ETC2_R8G8B8A1_UNORM_BLOCK | Format::ETC2_R8G8B8A1_SRGB_BLOCK => {
            block(8, blocks::decode_etc2_rgba1)
        }
        Format::ETC2_R8G8B8A8_UNORM_BLOCK | Format::ETC2_R8G8B8A8_SRGB_BLOCK => {
            block(16, blocks::decode_etc2_rgba8)
        }
        Format::EAC_R11_UNORM_BLOCK => block(8, blocks::decode_eacr),
        Format::EAC_R11G11_UNORM_BLOCK => block(16, blocks::decode_eacrg),
        other => {
            // 157 to 184 are ASTC with all block sizes and 8 bits a channel.
            let number = other.value();
            if (157..=184).contains(&number) {
                return Ok(Kind::Basis);
            }
            return Err(format!("its KTX2 format (VkFormat {number}) is not read"));
        }
    })
}

fn header(bytes: &[u8]) -> Result<Header, String> {
    let start = bytes.first_chunk::<HEADER_BYTES>().ok_or("its KTX2 header is cut off")?;
    Header::from_bytes(start).map_err(|error| format!("its KTX2 header is broken: {error}"))
}

fn finest_level(bytes: &[u8]) -> Result<LevelIndex, String> {
    let entry = bytes
        .get(HEADER_BYTES..)
        .and_then(|rest| rest.first_chunk())
        .ok_or("its KTX2 header is cut off")?;
    Ok(LevelIndex::from_bytes(entry))
}

fn slice(bytes: &[u8], offset: u64, length: u64) -> Result<&[u8], String> {
    let begin = usize::try_from(offset).ok();
    let end = offset.checked_add(length).and_then(|end| usize::try_from(end).ok());
    begin
        .zip(end)
        .and_then(|(begin, end)| bytes.get(begin..end))
        .ok_or_else(|| format!("{length} bytes at byte {offset} do not fit in its KTX2 file"))
}

/// The bytes of a level, at least `wanted` of them.
fn inflate<'a>(
    bytes: &'a [u8],
    header: &Header,
    level: &LevelIndex,
    wanted: usize,
) -> Result<Cow<'a, [u8]>, String> {
    let stored = slice(bytes, level.byte_offset, level.byte_length)?;
    let data = match header.supercompression_scheme {
        None => Cow::Borrowed(stored),
        Some(SupercompressionScheme::Zstandard) => {
            let broken =
                |error: &dyn std::fmt::Display| format!("its zstd data is broken: {error}");
            let decoder = StreamingDecoder::new_with_max_window_size(stored, LARGEST_WINDOW_BYTES);
            let mut data = Vec::new();
            // Surplus data is not read.
            decoder
                .map_err(|error| broken(&error))?
                .take(wanted as u64)
                .read_to_end(&mut data)
                .map_err(|error| broken(&error))?;
            Cow::Owned(data)
        }
        Some(other) => {
            return Err(format!("its KTX2 supercompression scheme {} is not read", other.value()));
        }
    };
    if data.len() < wanted {
        return Err(format!("its finest level has {} of {wanted} bytes", data.len()));
    }
    Ok(data)
}

/// The texels of a Basis Universal or ASTC image.
fn decode_basis(bytes: &[u8], header: &Header, level: &LevelIndex) -> Result<Vec<u8>, String> {
    let container = if header.supercompression_scheme == Some(SupercompressionScheme::BasisLZ) {
        without_metadata(bytes)
    } else {
        one_level(bytes, header, level)?
    };
    let broken = |error: basisu::Error| match error {
        basisu::Error::Unsupported { .. } => {
            "it holds a Basis Universal format of high dynamic range, which is not read".to_owned()
        }
        basisu::Error::VideoRequiresState => "it is a video".to_owned(),
        other => format!("its Basis Universal data is broken: {other:?}"),
    };
    let transcoder = basisu::Transcoder::new(&container).map_err(broken)?;
    transcoder.transcode(0, basisu::TargetFormat::Rgba32, basisu::DecodeFlags::NONE).map_err(broken)
}

/// The file without its key/value data, in which `basisu` 0.1.0 reads out of bounds.
fn without_metadata(bytes: &[u8]) -> Vec<u8> {
    let mut container = bytes.to_vec();
    // Offset and length of the keys and values.
    container[56..64].fill(0);
    container
}

/// A container with only the finest level, uncompressed: `basisu` allocates as much memory for a
/// compressed level as the file asks for.
fn one_level(bytes: &[u8], header: &Header, level: &LevelIndex) -> Result<Vec<u8>, String> {
    let index = header.index;
    let description = slice(bytes, index.dfd_byte_offset.into(), index.dfd_byte_length.into())?;
    // No format here needs more than a byte per texel of whole blocks.
    let blocks =
        u64::from(header.pixel_width.div_ceil(4)) * u64::from(header.pixel_height.div_ceil(4));
    if level.uncompressed_byte_length > blocks * 16 {
        return Err("its finest level is longer than its size can be".to_owned());
    }
    let data = inflate(bytes, header, level, level.uncompressed_byte_length as usize)?;
    let description_at = HEADER_BYTES + LevelIndex::LENGTH;
    let data_at = (description_at + description.len()).next_multiple_of(16);
    let mut container = Header {
        level_count: 1,
        supercompression_scheme: None,
        index: ktx2::Index {
            dfd_byte_offset: description_at as u32,
            dfd_byte_length: description.len() as u32,
            kvd_byte_offset: 0,
            kvd_byte_length: 0,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
        ..*header
    }
    .as_bytes()
    .to_vec();
    let length = data.len() as u64;
    let entry = LevelIndex {
        byte_offset: data_at as u64,
        byte_length: length,
        uncompressed_byte_length: length,
    };
    container.extend(entry.as_bytes());
    container.extend(description);
    container.resize(data_at, 0);
    container.extend(data.iter());
    Ok(container)
}
