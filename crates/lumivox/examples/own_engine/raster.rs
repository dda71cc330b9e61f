//! The engine's own scene and G-buffer pass.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec3};
use lumivox::{GBufferViews, Indices, VertexPositions};
use wgpu::util::DeviceExt as _;

/// Quads, each of one colour.
#[derive(Default)]
pub struct Mesh {
    vertices: Vec<Vertex>,
    indices: Vec<u16>,
    /// Albedo of each quad.
    pub colors: Vec<Vec3>,
    /// The first quad of those that move.
    pub first_moving: u32,
}

/// The uniform of a frame.
#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
pub struct Camera {
    pub clip_from_world: Mat4,
    /// The transforms of the quads that rest and of those that move.
    pub world_from_local: [Mat4; 2],
}

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Vertex {
    normal: [f32; 3],
    position: [f32; 3],
    albedo: [f32; 3],
}

impl Mesh {
    /// A parallelogram whose front is where `u` x `v` points.
    pub fn quad(&mut self, corner: Vec3, u: Vec3, v: Vec3, albedo: Vec3) {
        let first = self.vertices.len() as u16;
        let normal = u.cross(v).normalize().to_array();
        for position in [corner, corner + u, corner + u + v, corner + v] {
            let position = position.to_array();
            self.vertices.push(Vertex { normal, position, albedo: albedo.to_array() });
        }
        self.indices.extend([0, 1, 2, 0, 2, 3].map(|index| first + index));
        self.colors.push(albedo);
    }

    /// The corners of the box around all quads.
    pub fn bounds(&self) -> (Vec3, Vec3) {
        let positions = self.vertices.iter().map(|vertex| Vec3::from(vertex.position));
        positions
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(min, max), p| (min.min(p), max.max(p)))
    }
}

/// The pass, with its buffers and targets.
pub struct Raster {
    /// Vertices and indices, which the voxelizer reads as well.
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
    index_count: u32,
    /// The first index of the quads that move.
    first_moving: u32,
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
            bytemuck::bytes_of(&Camera::zeroed()),
            wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        );
        let pipeline = pipeline(device);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some("camera"),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
        });
        let (depth, colors) = targets(device, size);
        Self {
            vertices: buffer(
                bytemuck::cast_slice(&mesh.vertices),
                wgpu::BufferUsages::VERTEX | shared,
            ),
            indices: buffer(
                bytemuck::cast_slice(&mesh.indices),
                wgpu::BufferUsages::INDEX | shared,
            ),
            index_count: mesh.indices.len() as u32,
            first_moving: 6 * mesh.first_moving,
            camera,
            group,
            pipeline,
            depth,
            colors,
        }
    }

    pub fn resize(&mut self, device: &wgpu::Device, size: UVec2) {
        (self.depth, self.colors) = targets(device, size);
    }

    /// The positions among the engine's vertices, and its indices.
    pub fn geometry(&self) -> (VertexPositions, Indices) {
        let positions = VertexPositions {
            buffer: self.vertices.clone(),
            stride: size_of::<Vertex>() as u32,
            offset: std::mem::offset_of!(Vertex, position) as u64,
        };
        let format = wgpu::IndexFormat::Uint16;
        (positions, Indices { buffer: self.indices.clone(), format, offset: 0 })
    }

    /// The targets, as Lumivox wants them.
    pub fn views(&self) -> GBufferViews<'_> {
        let [normals, diffuse, specular, emission] = &self.colors;
        GBufferViews { depth: &self.depth, normals, diffuse, specular, emission, motion: None }
    }

    /// Draws the mesh.
    pub fn draw(&self, encoder: &mut wgpu::CommandEncoder, queue: &wgpu::Queue, camera: Camera) {
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
        pass.set_vertex_buffer(0, self.vertices.slice(..));
        pass.set_index_buffer(self.indices.slice(..), wgpu::IndexFormat::Uint16);
        pass.draw_indexed(0..self.first_moving, 0, 0..1);
        pass.draw_indexed(self.first_moving..self.index_count, 0, 1..2);
    }
}

/// The depth and the colours.
fn targets(device: &wgpu::Device, size: UVec2) -> (wgpu::TextureView, [wgpu::TextureView; 4]) {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
    let target = |format| texture(device, size, format, usage);
    (target(wgpu::TextureFormat::Depth32Float), FORMATS.map(target))
}

pub fn texture(
    device: &wgpu::Device,
    size: UVec2,
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::TextureView {
    let texture = device.create_texture(&wgpu::TextureDescriptor {
        label: Some("engine"),
        size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    });
    texture.create_view(&wgpu::TextureViewDescriptor::default())
}

fn pipeline(device: &wgpu::Device) -> wgpu::RenderPipeline {
    let shader = device.create_shader_module(wgpu::include_wgsl!("raster.wgsl"));
    let attributes = wgpu::vertex_attr_array![1 => Float32x3, 0 => Float32x3, 2 => Float32x3];
    let layout = wgpu::VertexBufferLayout {
        array_stride: size_of::<Vertex>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes: &attributes,
    };
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("G-buffer"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[Some(layout)],
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
