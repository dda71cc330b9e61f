//! A map as a file.

use std::io::{self, Cursor};

use exr::prelude::{SpecificChannels, WritableImage as _};
use glam::{UVec3, Vec3};
use half::f16;

use super::Lightmap;
use crate::half_texture;

impl Lightmap {
    /// The bytes of an OpenEXR file, in half floats, or in single precision if a value exceeds
    /// their range.
    ///
    /// # Errors
    /// When the encoder fails.
    pub fn to_exr(&self) -> io::Result<Vec<u8>> {
        let edge = self.edge as usize;
        let at = |at: exr::math::Vec2<usize>| self.light[at.y() * edge + at.x()];
        let mut bytes = Cursor::new(Vec::new());
        // Threads would append their blocks in the order in which they finish.
        let written = if self.brightest() <= f32::from(f16::MAX) {
            let channels = SpecificChannels::rgb(|place| {
                let [r, g, b] = at(place).to_array().map(f16::from_f32);
                (r, g, b)
            });
            let image = exr::image::Image::from_channels((edge, edge), channels);
            image.write().non_parallel().to_buffered(&mut bytes)
        } else {
            let channels = SpecificChannels::rgb(|place| {
                let [r, g, b] = at(place).to_array();
                (r, g, b)
            });
            let image = exr::image::Image::from_channels((edge, edge), channels);
            image.write().non_parallel().to_buffered(&mut bytes)
        };
        written.map_err(io::Error::other)?;
        Ok(bytes.into_inner())
    }

    /// The bytes of a KTX2 file with a texture of half floats (`R16G16B16A16_SFLOAT`), and the
    /// factor that converts its values to cd/m²: 1, unless a value exceeds the range of half
    /// floats.
    pub fn to_ktx2(&self) -> (Vec<u8>, f32) {
        let intensity = (self.brightest() / f32::from(f16::MAX)).max(1.0);
        let texel = |light: &Vec3| (*light / intensity).extend(1.0);
        let texels = half_texture::texels(self.light.iter().map(texel));
        // A depth of 0 means two dimensions.
        (half_texture::ktx2(UVec3::new(self.edge, self.edge, 0), &texels), intensity)
    }

    fn brightest(&self) -> f32 {
        self.light.iter().map(|light| light.max_element()).fold(0.0, f32::max)
    }
}
