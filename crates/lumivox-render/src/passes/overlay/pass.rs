//! Frames of an overlay, their mean, and the blend over the picture.

use glam::UVec2;
use lumivox::gpu::{
    BindGroupBuilder, Buffer, Kernel, Pipelines, Recorder, ShaderError, ShaderLibrary, Texture,
    TextureView, uniform_buffer,
};
use lumivox::{Gi, GiView};

use super::edges::{Edges, ranges};
use super::lines::{Lines, all};
use super::segment::{FRAME_FORMAT, SegmentView, layout};
use super::voxels::WireVoxels;
use super::{BACKGROUND, Overlay, Wireframe, Wires};
use crate::gpu::textures::ScreenTextures;
use crate::passes::accumulate::AccumulatePass;
use crate::passes::gbuffer::GBufferTargets;
use crate::picture::tone_map::{Encoding, ToneMapPass};
use crate::scene::GpuScene;

/// Bytes a pixel of an overlay: a frame in half floats, and two means.
pub(crate) const OVERLAY_BYTES_PER_PIXEL: u64 = 8 + 2 * 16;

/// The content of an overlay.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Shown {
    pub(crate) overlay: Overlay,
    pub(crate) voxel_level: u32,
}

/// The camera and the textures of an overlay's frame.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OverlayView<'a> {
    /// The camera, and the G-buffer of the same frame; it is used if surfaces hide parts of the
    /// overlay.
    pub(crate) view: &'a GiView,
    pub(crate) scene: &'a GpuScene,
    pub(crate) gi: &'a Gi,
    pub(crate) surfaces: &'a GBufferTargets,
}

/// Draws an overlay.
#[derive(Debug)]
pub(crate) struct OverlayPass {
    shown: Shown,
    shaders: ShaderLibrary,
    frame: TextureView,
    accumulate: AccumulatePass,
    blend: Kernel,
    blend_layout: wgpu::BindGroupLayout,
    segment_layout: wgpu::BindGroupLayout,
    segment_view: Buffer,
    /// The records of the scene's draws, and the ranges of their triangles.
    draws: Option<(Buffer, Buffer)>,
    /// The pipelines created so far.
    edges: Option<Edges>,
    lines: Option<Lines>,
    voxels: Option<WireVoxels>,
    /// Bytes of the textures.
    pub(crate) bytes: u64,
}

impl OverlayPass {
    /// Creates the textures for a picture of the given size.
    ///
    /// # Errors
    /// When a shader does not link.
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        size: UVec2,
    ) -> Result<Self, ShaderError> {
        let mut textures = ScreenTextures::new(device, size);
        let usage = wgpu::TextureUsages::STORAGE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT;
        let frame = textures.create("overlay", FRAME_FORMAT, usage).view();
        let accumulate = AccumulatePass::new(device, shaders, &mut textures, size, (&frame, None))?;
        let blend_layout = ToneMapPass::layout().texture_2d_unfilterable().build(device, "blend");
        let blend = Kernel::new(
            device,
            shaders,
            "render::passes::overlay::blend",
            "main",
            &[&blend_layout],
        )?;
        Ok(Self {
            shown: Shown { overlay: Overlay::default(), voxel_level: 0 },
            shaders: shaders.clone(),
            frame,
            accumulate,
            blend,
            blend_layout,
            segment_layout: layout(device),
            segment_view: uniform_buffer(
                device,
                "segments",
                &<SegmentView as bytemuck::Zeroable>::zeroed(),
            ),
            draws: None,
            edges: None,
            lines: None,
            voxels: None,
            bytes: textures.bytes,
        })
    }

    /// The number of frames of `shown` in the mean.
    pub(crate) fn frames(&self, shown: &Shown) -> u32 {
        if self.shown == *shown { self.accumulate.frames() } else { 0 }
    }

    /// Discards the frames so far.
    pub(crate) fn reset(&mut self) {
        self.accumulate.reset();
    }

    /// Adds a frame of `shown` to the mean, or starts the mean again if `shown` has changed; once
    /// per submission.
    ///
    /// # Errors
    /// When a shader does not link.
    pub(crate) fn record(
        &mut self,
        recorder: &mut Recorder,
        shown: &Shown,
        seen: OverlayView<'_>,
    ) -> Result<(), ShaderError> {
        let is_new = self.shown != *shown;
        if is_new {
            self.shown = shown.clone();
            self.reset();
        }
        let device = recorder.device().clone();
        self.prepare(seen.gi, is_new)?;
        let overlay = &self.shown.overlay;
        let background = if overlay.hides_surfaces { BACKGROUND } else { [0.0; 4] };
        recorder.stage("overlay");
        let has_wires = overlay.wire_voxels != Wires::Off && seen.gi.voxels().is_some();
        if let Some(voxels) = self.voxels.as_ref().filter(|_| has_wires) {
            let (from, what) = ((seen.gi, seen.view), (overlay, self.shown.voxel_level));
            voxels.record(recorder, from, what, background, &self.frame);
        }
        let records = &seen.scene.draw_records;
        if self.draws.as_ref().is_none_or(|(known, _)| known != records) {
            self.draws = Some((records.clone(), ranges(&device, seen.scene)));
        }
        self.draw(recorder, seen, (!has_wires).then_some(background));
        self.accumulate.record(recorder, None, 1);
        Ok(())
    }

    /// Creates missing pipelines.
    fn prepare(&mut self, gi: &Gi, is_new: bool) -> Result<(), ShaderError> {
        let device = gi.pipelines();
        let (overlay, shaders, layout) = (&self.shown.overlay, &self.shaders, &self.segment_layout);
        if overlay.wireframe != Wireframe::Off && self.edges.is_none() {
            self.edges = Some(Edges::new(device, shaders, layout)?);
        }
        if overlay.wire_voxels != Wires::Off && self.voxels.is_none() {
            self.voxels = Some(WireVoxels::new(device, shaders, gi)?);
        }
        if is_new {
            let lines = all(overlay, gi.grid());
            match &mut self.lines {
                Some(pass) => pass.set(device, &lines),
                None if lines.is_empty() => {}
                None => self.lines = Some(Lines::new(device, shaders, layout, &lines)?),
            }
        }
        Ok(())
    }

    /// Draws edges and lines, over a background if one is given.
    fn draw(&self, recorder: &mut Recorder, seen: OverlayView<'_>, background: Option<[f32; 4]>) {
        let Some((records, ranges)) = &self.draws else { return };
        let device = recorder.device().clone();
        let overlay = &self.shown.overlay;
        let segment_view = SegmentView::new(seen.view, overlay);
        recorder.queue().write_buffer(&self.segment_view, 0, bytemuck::bytes_of(&segment_view));
        let surfaces = seen.surfaces.views();
        let group = BindGroupBuilder::new(&self.segment_layout)
            .buffer(&self.segment_view)
            .buffer(records)
            .view(surfaces.depth)
            .view(surfaces.normals)
            .buffer(ranges)
            .build(&device, "segments");
        let load = background.map_or(wgpu::LoadOp::Load, |color| {
            let [r, g, b, a] = color.map(f64::from);
            wgpu::LoadOp::Clear(wgpu::Color { r, g, b, a })
        });
        let target = wgpu::RenderPassColorAttachment {
            view: &self.frame,
            depth_slice: None,
            resolve_target: None,
            ops: wgpu::Operations { load, store: wgpu::StoreOp::Store },
        };
        recorder.render("overlay", &[Some(target)], None, |pass| {
            pass.bind(0, &group);
            let wires = self.edges.as_ref().filter(|_| overlay.wireframe != Wireframe::Off);
            if let Some(edges) = wires {
                edges.draw(&device, pass, seen.scene);
            }
            if let Some(lines) = &self.lines {
                lines.draw(pass);
            }
        });
    }

    /// Tone maps a picture and blends the mean over it; once per submission.
    pub(crate) fn blend(
        &self,
        recorder: &mut Recorder,
        tone_map: &ToneMapPass,
        picture: &Texture,
        encoding: Encoding,
    ) {
        let over = self.accumulate.mean().view();
        let kernel = (&self.blend, &self.blend_layout);
        tone_map.record_below(recorder, picture, encoding, kernel, &over);
    }
}
