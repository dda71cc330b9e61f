//! Shared by the passes that rasterize: vertex layouts, reversed depth, draws.

use std::ops::Range;

use lumivox::gpu::pipelines::{DrawPipeline, DrawPlan, Shader};
use lumivox::gpu::{Pipelines, RenderPass, ShaderError, TextureView};

use crate::scene::{AllAttributes, Attributes, SceneDraw, Shading, VertexBuffers};

/// The format of depths.
pub const DEPTH_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// The vertex buffers of moved objects: positions, and former positions.
pub(crate) const MOVED_POSITIONS: [Option<wgpu::VertexBufferLayout<'static>>; 2] =
    [Some(stream::<[f32; 3]>(&POSITION)), Some(stream::<[f32; 3]>(&FORMER_POSITION))];

const POSITION: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![0 => Float32x3];
const FORMER_POSITION: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![1 => Float32x3];
const TEXCOORD: [wgpu::VertexAttribute; 1] = wgpu::vertex_attr_array![1 => Float32x2];
const SHADING: [wgpu::VertexAttribute; 2] =
    wgpu::vertex_attr_array![2 => Float32x3, 3 => Float32x4];
const ALL: [wgpu::VertexAttribute; 3] =
    wgpu::vertex_attr_array![1 => Float32x2, 4 => Float32x2, 5 => Unorm16x4];

const fn stream<T>(
    attributes: &'static [wgpu::VertexAttribute],
) -> wgpu::VertexBufferLayout<'static> {
    wgpu::VertexBufferLayout {
        array_stride: size_of::<T>() as u64,
        step_mode: wgpu::VertexStepMode::Vertex,
        attributes,
    }
}

/// Vertex buffers by slot: positions, attributes, normals and tangents.
pub(crate) type Streams = [Option<wgpu::VertexBufferLayout<'static>>; 3];

/// The vertex buffers of a batch with these attributes.
pub(crate) const fn streams(attributes: Attributes) -> Streams {
    let attributes = match attributes {
        Attributes::Texcoords => stream::<[f32; 2]>(&TEXCOORD),
        Attributes::All => stream::<AllAttributes>(&ALL),
    };
    [Some(stream::<[f32; 3]>(&POSITION)), Some(attributes), Some(stream::<Shading>(&SHADING))]
}

/// A pipeline that draws triangles against a reversed depth buffer: nearer is greater.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RasterPipeline<'a> {
    pub(crate) shader: &'a Shader,
    pub(crate) vertex: &'a str,
    pub(crate) fragment: Option<&'a str>,
    pub(crate) targets: &'a [Option<wgpu::ColorTargetState>],
    pub(crate) vertex_buffers: &'a [Option<wgpu::VertexBufferLayout<'static>>],
    pub(crate) groups: &'a [&'a wgpu::BindGroupLayout],
    pub(crate) cull_mode: Option<wgpu::Face>,
    pub(crate) depth: Depth,
}

/// How a pass uses the depth buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Depth {
    /// Triangles hide what is behind them.
    Hides,
    /// Triangles are depth-tested but do not write depth.
    InFront,
    /// Triangles are drawn only where they are the visible surface.
    OfVisible,
}

impl RasterPipeline<'_> {
    /// # Errors
    /// When the shader has no such entry point.
    pub(crate) fn create(self, pipelines: &Pipelines) -> Result<DrawPipeline, ShaderError> {
        let fragment = self.fragment.map(|entry| self.shader.entry(entry)).transpose()?;
        Ok(pipelines.draw(DrawPlan {
            fragment,
            targets: self.targets.to_vec(),
            vertex_buffers: self.vertex_buffers.to_vec(),
            groups: self.groups.iter().map(|group| (*group).clone()).collect(),
            primitive: wgpu::PrimitiveState {
                front_face: wgpu::FrontFace::Ccw,
                cull_mode: self.cull_mode,
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(self.depth == Depth::Hides),
                depth_compare: Some(match self.depth {
                    Depth::Hides | Depth::InFront => wgpu::CompareFunction::Greater,
                    Depth::OfVisible => wgpu::CompareFunction::Equal,
                }),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            ..DrawPlan::new(self.shader, self.vertex)?
        }))
    }
}

/// A depth target, cleared to infinitely far.
pub(crate) fn depth_attachment(view: &TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations {
            load: wgpu::LoadOp::Clear(0.0),
            store: wgpu::StoreOp::Store,
        }),
        stencil_ops: None,
    }
}

/// Draws a run of triangles once for each record; the instance index selects the record in the
/// shader.
pub(crate) fn draw(
    pass: &mut RenderPass<'_>,
    batch: &VertexBuffers,
    draw: &SceneDraw,
    records: Range<u32>,
) {
    pass.set_index_buffer(batch.indices.slice(..), wgpu::IndexFormat::Uint32);
    pass.draw_indexed(draw.indices.clone(), draw.base_vertex, records);
}
