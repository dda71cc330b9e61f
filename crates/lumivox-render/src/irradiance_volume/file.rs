//! A volume as a KTX2 file, in Bevy's layout (the documentation of
//! `bevy_pbr::light_probe::irradiance_volume`, 0.20).

use glam::{UVec3, Vec3};
use half::f16;
use ktx2::dfd::{Basic, Block};
use ktx2::{Format, Header, Index, LevelIndex};

use super::IrradianceVolume;

/// Key and value of the KTX2 metadata entry for the writing program (KTX 2.0, section 3.11.2).
const WRITER: &[u8] = b"KTXwriter\0Lumivox\0";

impl IrradianceVolume {
    /// The bytes of a KTX2 file with a texture of half floats (`R16G16B16A16_SFLOAT`), and the
    /// factor that converts its values to cd/m²: 1, unless a value exceeds the range of half
    /// floats.
    ///
    /// The texture of (Rx, Ry, Rz) probes has the size (Rx, 2 Ry, 3 Rz). Along z are the axes x, y
    /// and z. Along y is first the light on surfaces that face along the axis, then the light on
    /// those that face against it. Bevy's shader reads it in this order.
    ///
    /// # Panics
    /// Never: the texture's format has a descriptor.
    pub fn to_ktx2(&self) -> (Vec<u8>, f32) {
        let brightest =
            self.light.iter().flatten().map(|light| light.max_element()).fold(0.0, f32::max);
        let intensity = (brightest / f32::from(f16::MAX)).max(1.0);
        let texels = self.texels(intensity);

        let (descriptor, type_size) =
            Basic::from_format(Format::R16G16B16A16_SFLOAT).expect("a format of colours");
        let block = Block::Basic(descriptor).to_vec();
        let size = self.grid.cells * UVec3::new(1, 2, 3);
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
        (file, intensity)
    }

    fn texels(&self, intensity: f32) -> Vec<u8> {
        let UVec3 { x: width, y: height, z: depth } = self.grid.cells;
        let mut bytes = Vec::with_capacity(self.light.len() * 6 * 8);
        for axis in 0..3 {
            for z in 0..depth {
                for against in 0..2 {
                    for at in (0..height).flat_map(|y| (0..width).map(move |x| UVec3::new(x, y, z)))
                    {
                        let light: Vec3 =
                            self.light[self.grid.index(at)][2 * axis + against] / intensity;
                        let texel = light.extend(1.0).to_array().map(f16::from_f32);
                        bytes.extend(texel.into_iter().flat_map(f16::to_le_bytes));
                    }
                }
            }
        }
        bytes
    }
}
