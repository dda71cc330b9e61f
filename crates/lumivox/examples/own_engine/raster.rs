//! The engine's own scene and G-buffer pass.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec3};
use lumivox::GBufferViews;
use wgpu::util::DeviceExt as _;

/// Quads, each of one colour.
#[derive(Default)]
pub struct Mesh {
    positions: Vec<[f32; 3]>,
    attributes: Vec<Attributes>,
    indices: Vec<u32>,
    /// Albedo of each quad.
    pub colors: Vec<Vec3>,
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Attributes {
    normal: [f32; 3],
    albedo: [f32; 3],
}

impl Mesh {
    /// A parallelogram whose front is where `u` x `v` points.
    pub fn quad(&mut self, corner: Vec3, u: Vec3, v: Vec3, albedo: Vec3) {
        let first = self.positions.len() as u32;
        let normal = u.cross(v).normalize().to_array();
        for position in [corner, corner + u, corner + u + v, corner + v] {
            self.positions.push(position.to_array());
            self.attributes.push(Attributes { normal, albedo: albedo.to_array() });
        }
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|index| first + index));
        self.colors.push(albedo);
    }

    /// The corners of the box around all quads.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let positions = self.positions.iter().map(|position| Vec3::from(*position));
        positions
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)))
    }
}

/// The pass, with its buffers and targets.
pub struct Raster {
    /// Vertex positions, which the voxelizer reads as well.
    pub positions: wgpu::Buffer,
    /// Indices, which the voxelizer reads as well.
    pub indices: wgpu::Buffer,
    attributes: wgpu::Buffer,
    index_count: u32,
    camera: wgpu::Buffer,
    group: wgpu::BindGroup,
    pipeline: wgpu::RenderPipeline,
    depth: wgpu::TextureView,
    /// Normals, diffuse, specular, emission.
    colors: [wgpu::TextureView; 4],
}

const FORMATS: [wgpu::TextureFormat; 4] = [
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba8Unorm,
    wgpu::TextureFormat::Rgba8Unorm,
    wgpu::TextureFormat::Rgba16Float,
];

impl Raster {
    /// Uploads the mesh and makes the targets.
    pub fn new(device: &wgpu::Device, mesh: &Mesh, size: UVec2) -> Self {
        let buffer = |contents: &[u8], usage| {
            device.create_buffer_init(&wgpu::util::BufferInitDescriptor {
                label: Some("engine"),
                contents,
                usage,
            })
        };
        let shared = wgpu::BufferUsages::STORAGE;
        let camera = buffer(
            bytemuck::bytes_of(&Mat4::IDENTITY),
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        );
        let texture = |format| {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("G-buffer"),
                size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT
                    | wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            });
            texture.create_view(&wgpu::TextureViewDescriptor::default())
        };
        let pipeline = pipeline(device);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
        });
        Self {
            positions: buffer(
                bytemuck::cast_slice(&mesh.positions),
                wgpu::BufferUsages::VERTEX | shared,
            ),
            indices: buffer(
                bytemuck::cast_slice(&mesh.indices),
                wgpu::BufferUsages::INDEX | shared,
            ),
            attributes: buffer(bytemuck::cast_slice(&mesh.attributes), wgpu::BufferUsages::VERTEX),
            index_count: mesh.indices.len() as u32,
            camera,
            group,
            pipeline,
            depth: texture(wgpu::TextureFormat::Depth32Float),
            colors: FORMATS.map(texture),
        }
    }

    /// The targets, as Lumivox wants them.
    pub fn views(&self) -> GBufferViews<'_> {
        let [normals, diffuse, specular, emission] = &self.colors;
        GBufferViews { depth: &self.depth, normals, diffuse, specular, emission }
    }

    /// Draws the mesh.
    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, queue: &wgpu::Queue, camera: Mat4) {
        queue.write_buffer(&self.camera, 0, bytemuck::bytes_of(&camera));
        let colors = self.colors.each_ref().map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("G-buffer"),
            color_attachments: &colors,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &self.depth,
                // Reversed z: 0 is infinitely far.
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, &self.group, &[]);
        pass.set_vertex_buffer(0, self.positions.slice(..));
        pass.set_vertex_buffer(1, self.attributes.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint32);
        pass.draw_indexed(0..self.index_count, 0, 0..1);
    }
}

fn pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
    let shader = device.create_shader_module(wgpu::include_wgsl!("raster.wgsl"));
    let position = wgpu::vertex_attr_array![0 => Float32x3];
    let attributes = wgpu::vertex_attr_array![1 => Float32x3, 2 => Float32x3];
    let layout = |attributes, array_stride| {
        Some(wgpu::VertexBufferLayout {
            array_stride,
            step_mode: wgpu::VertexStepMode::Vertex,
            attributes,
        })
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("G-buffer"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[layout(&position, 12), layout(&attributes, size_of::<Attributes>() as u64)],
        },
        primitive: wgpu::PrimitiveState { cull_mode: Some(wgpu::Face::Back), ..Default::default() },
        depth_stencil: Some(wgpu::DepthStencilState {
            format: wgpu::TextureFormat::Depth32Float,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Greater),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &FORMATS.map(|format| Some(format.into())),
        }),
        multiview_mask: None,
        cache: None,
    })
}
