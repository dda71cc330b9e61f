//! Textures of half floats as KTX2 files.

use glam::{UVec3, Vec4};
use half::f16;
use ktx2::dfd::{Basic, Block};
use ktx2::{Format, Header, Index, LevelIndex};

/// Key and value of the KTX2 metadata entry for the writing program (KTX 2.0, section 3.11.2).
const WRITER: &[u8] = b"KTXwriter\0Lumivox\0";

/// The bytes of texels in half floats.
pub(crate) fn texels(values: impl Iterator<Item = Vec4>) -> Vec<u8> {
    values
        .flat_map(|value| value.to_array().map(f16::from_f32))
        .flat_map(f16::to_le_bytes)
        .collect()
}

/// The bytes of a KTX2 file with one level of texels (`R16G16B16A16_SFLOAT`). A depth of 0 means
/// two dimensions.
///
/// # Panics
/// Never: the texture's format has a descriptor.
pub(crate) fn ktx2(size: UVec3, texels: &[u8]) -> Vec<u8> {
    let (descriptor, type_size) =
        Basic::from_format(Format::R16G16B16A16_SFLOAT).expect("a format of colours");
    let block = Block::Basic(descriptor).to_vec();
    let descriptor_at = Header::LENGTH + LevelIndex::LENGTH;
    let descriptor_length = 4 + block.len();
    let writer_at = descriptor_at + descriptor_length;
    let texels_at = (writer_at + 4 + WRITER.len()).next_multiple_of(8);
    let header = Header {
        format: Some(Format::R16G16B16A16_SFLOAT),
        type_size,
        pixel_width: size.x,
        pixel_height: size.y,
        pixel_depth: size.z,
        layer_count: 0,
        face_count: 1,
        level_count: 1,
        supercompression_scheme: None,
        index: Index {
            dfd_byte_offset: descriptor_at as u32,
            dfd_byte_length: descriptor_length as u32,
            kvd_byte_offset: writer_at as u32,
            kvd_byte_length: (4 + WRITER.len()).next_multiple_of(4) as u32,
            sgd_byte_offset: 0,
            sgd_byte_length: 0,
        },
    };
    let bytes = texels.len() as u64;
    let level = LevelIndex {
        byte_offset: texels_at as u64,
        byte_length: bytes,
        uncompressed_byte_length: bytes,
    };
    let mut file = Vec::with_capacity(texels_at + texels.len());
    file.extend(header.as_bytes());
    file.extend(level.as_bytes());
    file.extend((descriptor_length as u32).to_le_bytes());
    file.extend(block);
    file.extend((WRITER.len() as u32).to_le_bytes());
    file.extend(WRITER);
    file.resize(texels_at, 0);
    file.extend(texels);
    file
}
