//! Textures read back to the CPU.

use bytemuck::Pod;
use glam::UVec2;
use lumivox::gpu::{Buffer, Texture};

use crate::gpu::textures::extent;
use crate::{Gpu, RenderError};

/// The most bytes in one read-back, well below WebGPU's default limit of 256 MiB per buffer.
const BAND_BYTES: u64 = 64 << 20;

/// Reads one texel of a 2D texture of type `T`; the texture needs `COPY_SRC`.
pub(crate) async fn read_texel<T: Pod>(
    gpu: &Gpu,
    texture: &Texture,
    at: UVec2,
) -> Result<T, RenderError> {
    let descriptor = wgpu::BufferDescriptor {
        label: Some("a texel"),
        size: size_of::<T>() as u64,
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    };
    let buffer = Buffer::new(&gpu.device, &descriptor);
    let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: 0,
            origin: wgpu::Origin3d { x: at.x, y: at.y, z: 0 },
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &buffer,
            layout: wgpu::TexelCopyBufferLayout::default(),
        },
        extent(UVec2::ONE),
    );
    gpu.queue.submit([encoder.finish()]);
    let bytes = 0..size_of::<T>() as u64;
    let texels: Vec<T> = lumivox::gpu::read_buffer(&gpu.device, &gpu.queue, &buffer, bytes).await?;
    Ok(texels.first().copied().unwrap_or_else(T::zeroed))
}

/// Reads all texels of a 2D texture of type `T`, row by row; the texture needs `COPY_SRC`.
pub(crate) async fn read_texture<T: Pod>(
    gpu: &Gpu,
    texture: &Texture,
) -> Result<Vec<T>, RenderError> {
    let row_bytes = texture.width() * size_of::<T>() as u32;
    let padded = row_bytes.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let band_rows = (BAND_BYTES / u64::from(padded)).clamp(1, texture.height().into()) as u32;
    let descriptor = wgpu::BufferDescriptor {
        label: Some("rows of a texture"),
        size: u64::from(padded) * u64::from(band_rows),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::COPY_SRC,
        mapped_at_creation: false,
    };
    let buffer = Buffer::new(&gpu.device, &descriptor);
    let mut texels = Vec::with_capacity((texture.width() * texture.height()) as usize);
    let mut first = 0;
    while first < texture.height() {
        let rows = band_rows.min(texture.height() - first);
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        encoder.copy_texture_to_buffer(
            wgpu::TexelCopyTextureInfo {
                texture,
                mip_level: 0,
                origin: wgpu::Origin3d { x: 0, y: first, z: 0 },
                aspect: wgpu::TextureAspect::All,
            },
            wgpu::TexelCopyBufferInfo {
                buffer: &buffer,
                layout: wgpu::TexelCopyBufferLayout {
                    offset: 0,
                    bytes_per_row: Some(padded),
                    rows_per_image: None,
                },
            },
            extent(UVec2::new(texture.width(), rows)),
        );
        gpu.queue.submit([encoder.finish()]);
        let bytes = 0..u64::from(padded) * u64::from(rows);
        let band: Vec<u8> =
            lumivox::gpu::read_buffer(&gpu.device, &gpu.queue, &buffer, bytes).await?;
        for row in band.chunks_exact(padded as usize) {
            // A byte vector need not be aligned for `T`.
            let texel_bytes = row[..row_bytes as usize].chunks_exact(size_of::<T>());
            texels.extend(texel_bytes.map(bytemuck::pod_read_unaligned::<T>));
        }
        first += rows;
    }
    Ok(texels)
}
