//! Textured walls and their faces.

use glam::{Vec2, Vec3};
use lumivox::{Geometry, SurfaceTexture};

use crate::voxelize::read::{Lab, along, morton_decode};
use crate::voxelize::scenes::{Mesh, unit_grid};

/// A square texture with all its mips, each texel the mean of four.
pub fn texture(lab: &Lab, edge: u32, texel: impl Fn(u32, u32) -> [u8; 4]) -> wgpu::TextureView {
    let levels = edge.ilog2() + 1;
    let texture = lab.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("test"),
        size: wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: 1 },
        mip_level_count: levels,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    });
    let mut texels: Vec<[u8; 4]> = (0..edge * edge).map(|i| texel(i % edge, i / edge)).collect();
    for level in 0..levels {
        let side = edge >> level;
        lab.queue.write_texture(
            wgpu::TexelCopyTextureInfo { mip_level: level, ..texture.as_image_copy() },
            texels.as_flattened(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * side),
                rows_per_image: Some(side),
            },
            wgpu::Extent3d { width: side, height: side, depth_or_array_layers: 1 },
        );
        let half = side / 2;
        texels = (0..half * half)
            .map(|i| {
                let (x, y) = (i % half.max(1), i / half.max(1));
                std::array::from_fn(|c| {
                    let at =
                        |dx, dy| u32::from(texels[((2 * y + dy) * side + 2 * x + dx) as usize][c]);
                    ((at(0, 0) + at(1, 0) + at(0, 1) + at(1, 1) + 2) / 4) as u8
                })
            })
            .collect();
    }
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

pub fn sampler(lab: &Lab) -> wgpu::Sampler {
    lab.device.create_sampler(&wgpu::SamplerDescriptor {
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::Repeat,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

pub fn textured(lab: &Lab, view: wgpu::TextureView) -> SurfaceTexture {
    SurfaceTexture::new(view, sampler(lab))
}

/// A wall of 8 by 8 voxels in the middle of a layer, with texture coordinates from 0 to 1.
pub fn wall() -> Mesh {
    let mut mesh = Mesh::default();
    let corner = |x: f32, y: f32| Vec3::new(4.0 + 8.0 * x, 4.0 + 8.0 * y, 6.5);
    let square = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
    mesh.quad(square.map(|uv| corner(uv.x, uv.y)));
    mesh.texcoords = square.to_vec();
    mesh
}

/// The faces with surface, by the voxel's column.
pub fn columns(lab: &Lab, geometry: &Geometry) -> Vec<([u32; 2], lumivox::voxels::FaceRecord)> {
    let list = lab.voxelize(&unit_grid(16), geometry);
    let mut faces = Vec::new();
    for face in list.faces.iter().filter(|face| along(face) > 1e-4) {
        let [x, y, z] = morton_decode(face.cell).to_array();
        assert_eq!(z, 6);
        faces.push(([x, y], *face));
    }
    faces
}
