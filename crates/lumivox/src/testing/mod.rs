//! Helpers of the crate's tests: a device, simple geometry, read-backs.

#[path = "../../tests/it/common/mod.rs"]
mod common;
pub(crate) mod nodes;

use bytemuck::Pod;
use glam::{Mat4, Vec3};
use wgpu::util::DeviceExt as _;

use lumivox::gpu::{read_buffer, storage_buffer};
use lumivox::{Draw, Geometry, GeometryBatch, Gi, SurfaceMaterial};

pub(crate) use common::device;

/// Triangles with one material each, for small scenes made by hand.
#[derive(Default)]
pub(crate) struct SceneBuilder {
    positions: Vec<[f32; 3]>,
    draws: Vec<Draw>,
    materials: Vec<SurfaceMaterial>,
}

impl SceneBuilder {
    /// A parallelogram; `u` x `v` points away from its front.
    pub(crate) fn quad(
        mut self,
        corner: Vec3,
        u: Vec3,
        v: Vec3,
        material: SurfaceMaterial,
    ) -> Self {
        let corners = [corner, corner + u, corner + u + v, corner, corner + u + v, corner + v];
        self.draws.push(Draw {
            first_index: self.positions.len() as u32,
            index_count: 6,
            base_vertex: 0,
            material: self.materials.len() as u32,
            world_from_local: Mat4::IDENTITY,
            is_static: false,
            bounds: Some([
                corners.into_iter().fold(corner, Vec3::min),
                corners.into_iter().fold(corner, Vec3::max),
            ]),
        });
        self.positions.extend(corners.map(|corner| corner.to_array()));
        self.materials.push(material);
        self
    }

    /// The inside of an axis-aligned box.
    pub(crate) fn room(mut self, min: Vec3, max: Vec3, material: &SurfaceMaterial) -> Self {
        let size = max - min;
        for axis in 0..3 {
            let u = Vec3::AXES[(axis + 1) % 3] * size;
            let v = Vec3::AXES[(axis + 2) % 3] * size;
            let far = min + Vec3::AXES[axis] * size;
            self = self.quad(min, u, v, material.clone()).quad(far, v, u, material.clone());
        }
        self
    }

    /// Applies a transform to all draws so far.
    pub(crate) fn transformed(mut self, world_from_local: Mat4) -> Self {
        for draw in &mut self.draws {
            draw.world_from_local = world_from_local;
        }
        self
    }

    /// Marks all draws so far as static.
    pub(crate) fn fixed(mut self) -> Self {
        for draw in &mut self.draws {
            draw.is_static = true;
        }
        self
    }

    pub(crate) fn build(self, device: &wgpu::Device) -> Geometry {
        let buffer = |bytes: &[u8]| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("test geometry"),
                contents: bytes,
                usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_SRC,
            })
        };
        let indices: Vec<u32> = (0..self.positions.len() as u32).collect();
        let positions = buffer(bytemuck::cast_slice(&self.positions));
        let batch =
            GeometryBatch::new(positions, buffer(bytemuck::cast_slice(&indices)), self.draws);
        Geometry::new(vec![batch], self.materials)
    }
}

/// A Lambert surface.
pub(crate) fn lambert(reflectance: f32, emission: f32) -> SurfaceMaterial {
    SurfaceMaterial {
        reflectance: Vec3::splat(reflectance).extend(1.0),
        emission: Vec3::splat(emission),
        ..SurfaceMaterial::default()
    }
}

/// A box-shaped room with walls of different colours, an emissive tilted panel, and a tilted plate:
/// it has every lobe, tilted or not, with radiance that differs from place to place.
pub(crate) fn busy_room() -> SceneBuilder {
    let tinted = |r, g, b, emission| SurfaceMaterial {
        reflectance: Vec3::new(r, g, b).extend(1.0),
        emission,
        ..SurfaceMaterial::default()
    };
    SceneBuilder::default()
        .room(Vec3::ZERO, Vec3::new(1.0, 0.7, 0.9), &tinted(0.7, 0.6, 0.5, Vec3::splat(0.1)))
        .quad(
            Vec3::new(0.3, 0.55, 0.3),
            Vec3::new(0.0, 0.1, 0.35),
            Vec3::new(0.4, -0.05, 0.0),
            SurfaceMaterial {
                double_sided: true,
                ..tinted(0.2, 0.8, 0.4, Vec3::new(4.0, 3.0, 2.0))
            },
        )
        .quad(
            Vec3::new(0.25, 0.1, 0.2),
            Vec3::new(0.1, 0.2, 0.3),
            Vec3::new(0.3, 0.1, -0.1),
            SurfaceMaterial { double_sided: true, ..tinted(0.8, 0.1, 0.1, Vec3::ZERO) },
        )
}

/// The busy room, static, with a small box and a plate that move.
pub(crate) fn room_with_a_box() -> SceneBuilder {
    let half = Vec3::splat(0.06);
    busy_room().fixed().room(-half, half, &lambert(0.6, 0.7)).quad(
        Vec3::ZERO,
        Vec3::new(0.2, 0.03, 0.0),
        Vec3::new(0.0, 0.05, 0.2),
        lambert(0.3, 0.0),
    )
}

/// Moves the dynamic draws.
pub(crate) fn moved(geometry: &Geometry, place: Mat4) -> Geometry {
    let mut geometry = geometry.clone();
    for draw in &mut geometry.batches[0].draws {
        if !draw.is_static {
            draw.world_from_local = place;
        }
    }
    geometry
}

/// Waits until all submitted results are read back, including those of a rebuild.
///
/// Polling the device until its work is done is not enough: all tests share the device, and another
/// test's thread may have polled it first and not called the callback yet.
pub(crate) fn wait_until_read(device: &wgpu::Device, gi: &Gi) {
    loop {
        device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
        if !gi.status().is_pending {
            return;
        }
        std::thread::yield_now();
    }
}

/// The first `count` elements of a buffer.
pub(crate) fn read<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    buffer: &wgpu::Buffer,
    count: usize,
) -> Vec<T> {
    let bytes = (count * size_of::<T>()) as u64;
    pollster::block_on(read_buffer(device, queue, buffer, 0..bytes)).expect("the buffer is read")
}

/// The texels of a level of a 3D texture, x fastest, each of `T`'s size.
pub(crate) fn read_level<T: Pod>(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
    level: u32,
) -> Vec<T> {
    let size = texture.size();
    let extent = |n: u32| (n >> level).max(1);
    let (width, height) = (extent(size.width), extent(size.height));
    let depth = extent(size.depth_or_array_layers);
    let row = width * size_of::<T>() as u32;
    let padded_row = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let bytes = u64::from(padded_row) * u64::from(height) * u64::from(depth);
    let staging = storage_buffer(device, "texture read-back", bytes);
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    encoder.copy_texture_to_buffer(
        wgpu::TexelCopyTextureInfo {
            texture,
            mip_level: level,
            origin: wgpu::Origin3d::ZERO,
            aspect: wgpu::TextureAspect::All,
        },
        wgpu::TexelCopyBufferInfo {
            buffer: &staging,
            layout: wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(padded_row),
                rows_per_image: Some(height),
            },
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: depth },
    );
    queue.submit([encoder.finish()]);
    let data: Vec<u8> = read(device, queue, &staging, bytes as usize);
    data.chunks_exact(padded_row as usize)
        .flat_map(|padded| bytemuck::pod_collect_to_vec::<u8, T>(&padded[..row as usize]))
        .collect()
}

/// The coordinates of a Morton code.
pub(crate) fn morton_decode(code: u32) -> glam::UVec3 {
    let gather =
        |shift: u32| (0..10).fold(0, |n, bit| n | (((code >> (3 * bit + shift)) & 1) << bit));
    glam::UVec3::new(gather(0), gather(1), gather(2))
}
