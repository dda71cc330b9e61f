//! Screen-sized textures.

use glam::UVec2;
use lumivox::gpu::{Texture, TextureView};

/// Creates textures of one picture's size, and sums up their memory.
#[derive(Debug)]
pub(crate) struct ScreenTextures<'a> {
    device: &'a wgpu::Device,
    size: UVec2,
    /// Bytes of all textures created so far.
    pub(crate) bytes: u64,
}

impl<'a> ScreenTextures<'a> {
    pub(crate) fn new(device: &'a wgpu::Device, size: UVec2) -> Self {
        Self { device, size, bytes: 0 }
    }

    /// Creates a texture that passes write according to `usage`, and later passes read.
    pub(crate) fn create(
        &mut self,
        label: &str,
        format: wgpu::TextureFormat,
        usage: wgpu::TextureUsages,
    ) -> Texture {
        let texel_bytes = format.block_copy_size(None).unwrap_or(4);
        self.bytes += u64::from(self.size.x) * u64::from(self.size.y) * u64::from(texel_bytes);
        Texture::new(
            self.device,
            &wgpu::TextureDescriptor {
                label: Some(label),
                size: extent(self.size),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: usage | wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            },
        )
    }

    /// A view of a texture that a compute pass writes.
    pub(crate) fn storage(&mut self, label: &str, format: wgpu::TextureFormat) -> TextureView {
        self.create(label, format, wgpu::TextureUsages::STORAGE_BINDING).view()
    }

    /// A view of a texture that a render pass draws into.
    pub(crate) fn target(&mut self, label: &str, format: wgpu::TextureFormat) -> TextureView {
        self.create(label, format, wgpu::TextureUsages::RENDER_ATTACHMENT).view()
    }
}

pub(crate) fn extent(size: UVec2) -> wgpu::Extent3d {
    wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 }
}
