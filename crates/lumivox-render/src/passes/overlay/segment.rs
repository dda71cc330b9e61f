//! Shared by edges and lines: the camera, the G-buffer that hides them, and the pipeline.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec4, Vec4Swizzles as _};
use lumivox::GiView;
use lumivox::gpu::pipelines::{DrawPipeline, DrawPlan, Shader};
use lumivox::gpu::{LayoutBuilder, Pipelines, ShaderError};

use super::{Overlay, WIREFRAME_COLOR, WIREFRAME_WIDTH, Wireframe};

/// Format of the texture of an overlay's frame; it is blendable.
pub(crate) const FRAME_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// `SegmentView` of `segment.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct SegmentView {
    pub(crate) clip_from_world: Mat4,
    pub(crate) ray_middle: [f32; 3],
    pub(crate) wire_is_tested: u32,
    pub(crate) ray_across: [f32; 3],
    pub(crate) wire_width: f32,
    pub(crate) ray_up: [f32; 3],
    padding_0: u32,
    pub(crate) size: [f32; 2],
    padding_1: [u32; 2],
    pub(crate) wire_color: [f32; 4],
}

impl SegmentView {
    pub(super) fn new(view: &GiView, overlay: &Overlay) -> Self {
        // At infinity, clip-space points are directions; w is not exactly 0 because the matrix is
        // rounded.
        let clip_from_world = view.clip_from_world();
        let world_from_clip = clip_from_world.inverse();
        let position = view.camera().position;
        let ray = |column: Vec4| (column.xyz() - column.w * position).to_array();
        Self {
            clip_from_world,
            ray_middle: ray(world_from_clip.w_axis),
            wire_is_tested: u32::from(overlay.wireframe == Wireframe::Over),
            ray_across: ray(world_from_clip.x_axis),
            wire_width: WIREFRAME_WIDTH,
            ray_up: ray(world_from_clip.y_axis),
            padding_0: 0,
            size: view.size().as_vec2().to_array(),
            padding_1: [0; 2],
            wire_color: WIREFRAME_COLOR,
        }
    }
}

/// Bindings 0 to 4 of group 0: the view, the draws, depth and normals of surfaces, the draws'
/// triangles.
pub(super) fn layout(device: &Pipelines) -> wgpu::BindGroupLayout {
    LayoutBuilder::new(wgpu::ShaderStages::VERTEX_FRAGMENT)
        .uniform()
        .storage()
        .depth_2d()
        .texture_2d_unfilterable()
        .storage()
        .build(device, "segments")
}

/// A pipeline that draws quads over the target, without a depth buffer: fragments test depth
/// themselves.
///
/// # Errors
/// When the shader has no such entry points.
pub(super) fn pipeline(
    pipelines: &Pipelines,
    shader: &Shader,
    (vertex, fragment): (&str, &str),
    groups: [&wgpu::BindGroupLayout; 2],
) -> Result<DrawPipeline, ShaderError> {
    let target = wgpu::ColorTargetState {
        format: FRAME_FORMAT,
        blend: Some(wgpu::BlendState::PREMULTIPLIED_ALPHA_BLENDING),
        write_mask: wgpu::ColorWrites::ALL,
    };
    Ok(pipelines.draw(DrawPlan {
        fragment: Some(shader.entry(fragment)?),
        targets: vec![Some(target)],
        groups: groups.map(Clone::clone).to_vec(),
        ..DrawPlan::new(shader, vertex)?
    }))
}
