//! Render pipelines.

use std::ops::Deref;

use super::lazy::{Lazy, Plan, pipeline_layout};
use super::{Shader, ShaderEntry};
use crate::gpu::ShaderError;

/// The description of a render pipeline for triangles: one sample per pixel, one view.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct DrawPlan {
    /// The vertex shader.
    pub vertex: ShaderEntry,
    /// The fragment shader; `None` to write only depth.
    pub fragment: Option<ShaderEntry>,
    /// The colour targets of the fragment shader, by location.
    pub targets: Vec<Option<wgpu::ColorTargetState>>,
    /// Vertex buffers by slot.
    pub vertex_buffers: Vec<Option<wgpu::VertexBufferLayout<'static>>>,
    /// Layouts of the bind groups, from group 0.
    pub groups: Vec<wgpu::BindGroupLayout>,
    /// Primitive assembly.
    pub primitive: wgpu::PrimitiveState,
    /// The depth test; `None` to disable it.
    pub depth_stencil: Option<wgpu::DepthStencilState>,
}

impl DrawPlan {
    /// A plan that draws both sides of triangles without vertex buffers, targets, bind groups or a
    /// depth buffer, as a base for struct updates.
    ///
    /// # Errors
    /// If there is no entry point with that name.
    pub fn new(vertex: &Shader, entry: &str) -> Result<Self, ShaderError> {
        Ok(Self {
            vertex: vertex.entry(entry)?,
            fragment: None,
            targets: Vec::new(),
            vertex_buffers: Vec::new(),
            groups: Vec::new(),
            primitive: wgpu::PrimitiveState::default(),
            depth_stencil: None,
        })
    }
}

impl Plan for DrawPlan {
    type Pipeline = wgpu::RenderPipeline;

    fn create(
        &self,
        device: &wgpu::Device,
        cache: Option<&wgpu::PipelineCache>,
    ) -> wgpu::RenderPipeline {
        let label = self.fragment.as_ref().unwrap_or(&self.vertex).label();
        device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
            label: Some(&label),
            layout: Some(&pipeline_layout(device, &label, &self.groups)),
            vertex: wgpu::VertexState {
                module: self.vertex.module(),
                entry_point: Some(self.vertex.name()),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                buffers: &self.vertex_buffers,
            },
            primitive: self.primitive,
            depth_stencil: self.depth_stencil.clone(),
            multisample: wgpu::MultisampleState::default(),
            fragment: self.fragment.as_ref().map(|entry| wgpu::FragmentState {
                module: entry.module(),
                entry_point: Some(entry.name()),
                compilation_options: wgpu::PipelineCompilationOptions::default(),
                targets: &self.targets,
            }),
            multiview_mask: None,
            cache,
        })
    }
}

/// A render pipeline, created at its first use (by `Deref`) or earlier. Clones share it.
#[derive(Clone, Debug)]
pub struct DrawPipeline(pub(super) Lazy<DrawPlan>);

impl Deref for DrawPipeline {
    type Target = wgpu::RenderPipeline;

    fn deref(&self) -> &wgpu::RenderPipeline {
        self.0.get()
    }
}
