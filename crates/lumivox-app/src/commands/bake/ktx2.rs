//! A 3D texture as a KTX 2.0 file (Khronos 2024), in the format `E5B9G9R9_UFLOAT_PACK32`: four bytes a texel, which GPUs filter.

use glam::{UVec3, Vec3};

const IDENTIFIER: [u8; 12] =
    [0xab, b'K', b'T', b'X', b' ', b'2', b'0', 0xbb, b'\r', b'\n', 0x1a, b'\n'];
/// `VK_FORMAT_E5B9G9R9_UFLOAT_PACK32`.
const FORMAT: u32 = 123;
/// The brightest value: 511/512 of two to the 16th.
const BRIGHTEST: f32 = 65_408.0;
/// Bytes of the header with its index, and of one level's entry.
const HEADER_BYTES: u64 = 80;
const LEVEL_BYTES: u64 = 24;

/// The bytes of a file with one level, from texels with x fastest.
pub fn volume(size: UVec3, texels: &[Vec3]) -> Vec<u8> {
    let descriptor = descriptor();
    let descriptor_at = HEADER_BYTES + LEVEL_BYTES;
    let data_at = (descriptor_at + descriptor.len() as u64).next_multiple_of(4);
    let data_bytes = 4 * texels.len() as u64;
    let mut file = Vec::with_capacity((data_at + data_bytes) as usize);
    file.extend(IDENTIFIER);
    let words = |file: &mut Vec<u8>, words: &[u32]| {
        file.extend(words.iter().flat_map(|word| word.to_le_bytes()));
    };
    // Format, type size, size, layers (0: no array), faces, levels, no supercompression.
    words(&mut file, &[FORMAT, 4, size.x, size.y, size.z, 0, 1, 1, 0]);
    // Where the descriptor is; no key and value, no global data.
    words(&mut file, &[descriptor_at as u32, descriptor.len() as u32, 0, 0]);
    file.extend([0; 16]);
    for number in [data_at, data_bytes, data_bytes] {
        file.extend(number.to_le_bytes());
    }
    file.extend(descriptor);
    file.resize(data_at as usize, 0);
    words(&mut file, &texels.iter().map(|texel| rgb9e5(*texel)).collect::<Vec<u32>>());
    file
}

/// The data format descriptor (Khronos Data Format 1.3, section 5): three mantissas that share an exponent.
fn descriptor() -> Vec<u8> {
    const RGBSDA: u32 = 1;
    const BT709: u32 = 1;
    const LINEAR: u32 = 1;
    const EXPONENT: u32 = 0x20;
    let mut words = vec![
        0,
        // Version 2 of the block, of 24 bytes and six samples of 16.
        2 | (24 + 6 * 16) << 16,
        RGBSDA | BT709 << 8 | LINEAR << 16,
        // One texel a block, of four bytes.
        0,
        4,
        0,
    ];
    for channel in 0..3 {
        // Offset and length less one, in bits; the mantissa's value of one is 256, the exponent's bias 15.
        words.extend([(9 * channel) | 8 << 16 | channel << 24, 0, 0, 256]);
        words.extend([27 | 4 << 16 | (channel | EXPONENT) << 24, 0, 15, 31]);
    }
    let total = 4 * (words.len() as u32 + 1);
    std::iter::once(total).chain(words).flat_map(u32::to_le_bytes).collect()
}

/// Three values at 9 bits with one exponent of 5 (EXT_texture_shared_exponent).
fn rgb9e5(color: Vec3) -> u32 {
    let color = color.max(Vec3::ZERO).min(Vec3::splat(BRIGHTEST));
    let color = if color.is_finite() { color } else { Vec3::ZERO };
    let largest = color.max_element();
    // The least exponent whose 511 steps reach it.
    let mut exponent = (largest.max(f32::MIN_POSITIVE).log2().floor() as i32).max(-16) + 16;
    if (largest / step(exponent)).round() > 511.0 {
        exponent += 1;
    }
    let [r, g, b] = (color / step(exponent)).round().to_array().map(|value| value as u32);
    (exponent as u32) << 27 | b << 18 | g << 9 | r
}

/// The value of a mantissa of one.
fn step(exponent: i32) -> f32 {
    ((exponent - 15 - 9) as f32).exp2()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn decode(word: u32) -> Vec3 {
        let mantissas = UVec3::new(word & 511, word >> 9 & 511, word >> 18 & 511);
        mantissas.as_vec3() * step((word >> 27) as i32)
    }

    #[test]
    fn values_keep_eight_bits_of_the_brightest_channel() {
        for color in [
            Vec3::new(1.0, 0.5, 0.25),
            Vec3::new(511.6, 3.0, 0.0),
            Vec3::splat(65_000.0),
            Vec3::new(1e-4, 3e-5, 0.0),
            Vec3::new(0.998_9, 0.999_9, 0.1),
        ] {
            let error = (decode(rgb9e5(color)) - color).abs().max_element();
            assert!(error <= color.max_element() / 510.0, "{color} {}", decode(rgb9e5(color)));
        }
        assert_eq!(decode(rgb9e5(Vec3::ZERO)), Vec3::ZERO);
        assert_eq!(decode(rgb9e5(Vec3::splat(1e9))), Vec3::splat(BRIGHTEST));
        assert_eq!(decode(rgb9e5(Vec3::splat(f32::NAN))), Vec3::ZERO);
    }

    #[test]
    fn a_file_is_read_by_another_crate() {
        let size = UVec3::new(2, 4, 3);
        let texels: Vec<Vec3> = (0..24).map(|texel| Vec3::splat(texel as f32)).collect();
        let file = volume(size, &texels);
        let reader = ktx2::Reader::new(&file).unwrap();
        let header = reader.header();
        assert_eq!(header.format, Some(ktx2::Format::E5B9G9R9_UFLOAT_PACK32));
        assert_eq!([header.pixel_width, header.pixel_height, header.pixel_depth], [2, 4, 3]);
        assert_eq!((header.level_count, header.face_count, header.layer_count), (1, 1, 0));
        let level = reader.levels().next().unwrap();
        let words = level.data.chunks_exact(4).map(|word| u32::from_le_bytes(word.try_into().unwrap()));
        assert!(words.map(decode).eq(texels));
        assert_eq!(reader.dfd_blocks().count(), 1);
    }
}
