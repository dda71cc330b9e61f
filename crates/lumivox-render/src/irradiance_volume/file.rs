//! A volume as a KTX2 file, in Bevy's layout (the documentation of
//! `bevy_pbr::light_probe::irradiance_volume`, 0.20).

use glam::{UVec3, Vec4};
use half::f16;

use super::IrradianceVolume;
use crate::half_texture;

impl IrradianceVolume {
    /// The bytes of a KTX2 file with a texture of half floats (`R16G16B16A16_SFLOAT`), and the
    /// factor that converts its values to cd/m²: 1, unless a value exceeds the range of half
    /// floats.
    ///
    /// The texture of (Rx, Ry, Rz) probes has the size (Rx, 2 Ry, 3 Rz). Along z are the axes x, y
    /// and z. Along y is first the light on surfaces that face along the axis, then the light on
    /// those that face against it. Bevy's shader reads it in this order.
    pub fn to_ktx2(&self) -> (Vec<u8>, f32) {
        let brightest =
            self.light.iter().flatten().map(|light| light.max_element()).fold(0.0, f32::max);
        let intensity = (brightest / f32::from(f16::MAX)).max(1.0);
        let size = self.grid.cells * UVec3::new(1, 2, 3);
        let texels = half_texture::texels(self.texels(intensity).into_iter());
        (half_texture::ktx2(size, &texels), intensity)
    }

    fn texels(&self, intensity: f32) -> Vec<Vec4> {
        let UVec3 { x: width, y: height, z: depth } = self.grid.cells;
        let mut texels = Vec::with_capacity(self.light.len() * 6);
        for axis in 0..3 {
            for z in 0..depth {
                for against in 0..2 {
                    for at in (0..height).flat_map(|y| (0..width).map(move |x| UVec3::new(x, y, z)))
                    {
                        let light = self.light[self.grid.index(at)][2 * axis + against];
                        texels.push((light / intensity).extend(1.0));
                    }
                }
            }
        }
        texels
    }
}
