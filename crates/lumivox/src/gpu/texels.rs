//! Lists of texels of four words, in textures.
//!
//! Shaders read from textures what they look up most: software drivers read four words from a
//! texel in a small part of the time that they take from a buffer, and no limit of bindings bounds
//! a texture.

use super::{LayoutBuilder, Memory, Remedy, Texture};
use crate::GiError;

/// Texels per row: a texture may have as many on any device.
pub(crate) const TEXEL_COLUMNS: u32 = 8192;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;

/// A list of at least `count` zeros (`texels.wgsl`).
pub(crate) fn texels(device: &wgpu::Device, label: &str, count: u64) -> Texture {
    let rows = count.div_ceil(TEXEL_COLUMNS.into()).max(1) as u32;
    Texture::new(
        device,
        &wgpu::TextureDescriptor {
            label: Some(label),
            size: wgpu::Extent3d { width: TEXEL_COLUMNS, height: rows, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: FORMAT,
            usage: wgpu::TextureUsages::TEXTURE_BINDING
                | wgpu::TextureUsages::STORAGE_BINDING
                | wgpu::TextureUsages::COPY_SRC
                | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
    )
}

/// Bytes of a list.
pub(crate) fn texel_bytes(texels: &Texture) -> u64 {
    16 * u64::from(texels.width()) * u64::from(texels.height())
}

impl LayoutBuilder {
    /// A list that is read: `texture_2d<u32>`.
    #[must_use]
    pub(crate) fn texels(self) -> Self {
        self.texture(wgpu::TextureViewDimension::D2, wgpu::TextureSampleType::Uint)
    }

    /// A list that is written: `texture_storage_2d<rgba32uint, write>`.
    #[must_use]
    pub(crate) fn storage_texels(self) -> Self {
        self.storage_texture(wgpu::TextureViewDimension::D2, FORMAT)
    }
}

impl Memory<'_> {
    /// Checks that the device can create a list of texels.
    ///
    /// # Errors
    /// [`GiError::Limit`] if it has too many rows.
    pub(crate) fn check_texels(
        self,
        label: &str,
        count: u64,
        remedy: Remedy,
    ) -> Result<(), GiError> {
        let available = self.device().limits().max_texture_dimension_2d;
        let needed = count.div_ceil(TEXEL_COLUMNS.into());
        if needed <= u64::from(available) {
            return Ok(());
        }
        Err(GiError::Limit {
            what: format!("the texture of {label}"),
            needed,
            unit: "rows",
            limit: "max_texture_dimension_2d",
            available: available.into(),
            remedy: remedy.words(f64::from(available) / needed as f64),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::device;

    #[test]
    fn lists_too_long_for_a_texture_are_refused_with_a_remedy() {
        let (device, _) = device();
        let memory = Memory::new(&device);
        let most = u64::from(device.limits().max_texture_dimension_2d) * u64::from(TEXEL_COLUMNS);
        let check = |count| memory.check_texels("the surface", count, Remedy::Surface(512));
        check(most).expect("it fits");
        let text = check(4 * most).expect_err("it does not fit").to_string();
        assert!(text.starts_with("the texture of the surface"), "{text}");
        assert!(text.ends_with("a resolution of 256 would fit"), "{text}");
    }
}
