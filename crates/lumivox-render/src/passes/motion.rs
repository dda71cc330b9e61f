//! Motion of moving objects, for the light of earlier frames: 4 bytes a pixel (`Rg16Float`).
//!
//! Only objects that have moved since the last frame are drawn, where the G-buffer shows them. All
//! other pixels move with the camera.

use bytemuck::{Pod, Zeroable};
use glam::Mat4;
use lumivox::GiView;
use lumivox::gpu::pipelines::DrawPipeline;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, TextureView, storage_buffer, uniform_buffer,
};

use crate::passes::raster::{self, RasterPipeline};
use crate::scene::GpuScene;

/// The format of motion.
pub(crate) const MOTION_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rg16Float;

/// Bytes of a transform.
const TRANSFORM_BYTES: u64 = size_of::<Mat4>() as u64;

/// `MotionView` of `motion.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MotionView {
    clip_from_world: Mat4,
    previous_clip_from_world: Mat4,
}

/// Draws motion.
#[derive(Debug)]
pub(crate) struct MotionPass {
    pipeline: DrawPipeline,
    layout: wgpu::BindGroupLayout,
    view: Buffer,
    bound: Option<Bound>,
}

/// The buffers for one upload of a scene's draws.
#[derive(Debug)]
struct Bound {
    records: Buffer,
    former: Buffer,
    group: BindGroup,
}

impl MotionPass {
    /// Creates the pipeline.
    ///
    /// # Errors
    /// When the shader does not link.
    pub(crate) fn new(device: &Pipelines, shaders: &ShaderLibrary) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::new(wgpu::ShaderStages::VERTEX)
            .uniform()
            .storage()
            .storage()
            .build(device, "motion");
        let shader = device.shader(shaders, "render::passes::motion")?;
        let pipeline = RasterPipeline {
            shader: &shader,
            vertex: "vertex",
            fragment: Some("fragment"),
            targets: &[Some(MOTION_FORMAT.into())],
            vertex_buffers: &raster::MOVED_POSITIONS,
            groups: &[&layout],
            cull_mode: None,
            depth: raster::Depth::OfVisible,
        }
        .create(device)?;
        let view = uniform_buffer(device, "motion view", &MotionView::zeroed());
        Ok(Self { pipeline, layout, view, bound: None })
    }

    /// Draws the objects that have moved since the last frame; once per submission, after the
    /// G-buffer.
    pub(crate) fn record(
        &mut self,
        recorder: &mut Recorder,
        scene: &GpuScene,
        [motion, depth]: [&TextureView; 2],
        view: &GiView,
    ) {
        let color = wgpu::RenderPassColorAttachment {
            view: motion,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations {
                load: wgpu::LoadOp::Clear(wgpu::Color {
                    r: lumivox::AS_THE_CAMERA.into(),
                    g: lumivox::AS_THE_CAMERA.into(),
                    b: 0.0,
                    a: 0.0,
                }),
                store: wgpu::StoreOp::Store,
            },
        };
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: depth,
            depth_ops: None,
            stencil_ops: None,
        };
        let moved: Vec<u32> = scene.motion.moved().map(|(record, _)| record).collect();
        if !moved.is_empty() {
            self.upload(recorder, scene, view);
        }
        let (pipeline, bound) = (&self.pipeline, &self.bound);
        recorder.render("motion", &[Some(color)], Some(depth), |pass| {
            let Some(bound) = bound.as_ref().filter(|_| !moved.is_empty()) else { return };
            pass.set_pipeline(pipeline);
            pass.bind(0, &bound.group);
            for record in moved {
                let draw = scene.draw_of(record);
                let batch = &scene.batches[draw.batch];
                let former = scene.motion.positions(draw.batch).unwrap_or(&batch.positions);
                pass.set_vertex_buffer(0, batch.positions.slice(..));
                pass.set_vertex_buffer(1, former.slice(..));
                raster::draw(pass, batch, draw, record..record + 1);
            }
        });
    }

    fn upload(&mut self, recorder: &Recorder, scene: &GpuScene, view: &GiView) {
        let (device, queue) = (recorder.device(), recorder.queue());
        let records = &scene.draw_records;
        if self.bound.as_ref().is_none_or(|bound| bound.records != *records) {
            let former =
                storage_buffer(device, "former draws", scene.draws.len() as u64 * TRANSFORM_BYTES);
            let group = BindGroupBuilder::new(&self.layout)
                .buffer(&self.view)
                .buffer(records)
                .buffer(&former)
                .build(device, "motion");
            self.bound = Some(Bound { records: records.clone(), former, group });
        }
        let Some(bound) = &self.bound else { return };
        for (record, transform) in scene.motion.moved() {
            let offset = u64::from(record) * TRANSFORM_BYTES;
            queue.write_buffer(&bound.former, offset, bytemuck::bytes_of(&transform));
        }
        let view = MotionView {
            clip_from_world: view.clip_from_world(),
            previous_clip_from_world: view.previous_clip_from_world(),
        };
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view));
    }
}
