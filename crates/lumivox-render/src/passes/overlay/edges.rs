//! The edges of the scene's triangles.

use bytemuck::{Pod, Zeroable};
use lumivox::gpu::pipelines::DrawPipeline;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, RenderPass, ShaderError,
    ShaderLibrary, upload,
};

use super::segment;
use crate::scene::{GpuScene, SceneDraw};

/// Vertices of an edge: two triangles.
const EDGE_VERTICES: u32 = 6;

/// `EdgeRange` of `edges.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct EdgeRange {
    pub(crate) first_index: u32,
    pub(crate) base_vertex: u32,
    pub(crate) is_single_sided: u32,
    padding: u32,
}

/// Draws the edges of the scene's triangles.
#[derive(Debug)]
pub(super) struct Edges {
    pipeline: DrawPipeline,
    /// For each batch, its positions and indices.
    layout: wgpu::BindGroupLayout,
}

impl Edges {
    /// # Errors
    /// When the shader does not link.
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        view: &wgpu::BindGroupLayout,
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::new(wgpu::ShaderStages::VERTEX)
            .storage()
            .storage()
            .build(device, "edges");
        let shader = device.shader(shaders, "render::passes::overlay::edges")?;
        let entries = ("edge_vertex", "edge_fragment");
        let pipeline = segment::pipeline(device, &shader, entries, [view, &layout])?;
        Ok(Self { pipeline, layout })
    }

    /// Draws all edges, within a pass whose group 0 is bound.
    pub(super) fn draw(&self, device: &wgpu::Device, pass: &mut RenderPass<'_>, scene: &GpuScene) {
        let groups: Vec<BindGroup> = scene
            .batches
            .iter()
            .map(|batch| {
                let builder = BindGroupBuilder::new(&self.layout).buffer(&batch.positions);
                builder.buffer(&batch.indices).build(device, "edges")
            })
            .collect();
        pass.set_pipeline(&self.pipeline);
        for draw in &scene.draws {
            // Vertices are numbered by 32 bits, which are enough for 238 million triangles.
            let edges = draw.indices.len().min((u32::MAX / EDGE_VERTICES) as usize) as u32;
            pass.bind(1, &groups[draw.batch]);
            pass.draw(0..EDGE_VERTICES * edges, draw.record..draw.record + 1);
        }
    }
}

/// The ranges of triangles of a scene's draws, in the order of their records.
pub(super) fn ranges(device: &wgpu::Device, scene: &GpuScene) -> Buffer {
    let range = |draw: &SceneDraw| EdgeRange {
        first_index: draw.indices.start,
        base_vertex: draw.base_vertex as u32,
        is_single_sided: u32::from(!scene.materials[draw.material].is_double_sided),
        padding: 0,
    };
    let ranges: Vec<EdgeRange> =
        (0..scene.draws.len() as u32).map(|record| range(scene.draw_of(record))).collect();
    upload(device, "edges", &ranges)
}
