//! Figures of the last frame: the cost of its cones, and the age of its light.

use lumivox::gpu::read_buffer;

use super::Renderer;
use super::prepare::compile;
use crate::RenderError;
use crate::passes::figures::{FiguresPass, Sums};

/// Figures of the last frame, over one pixel in 64.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TraceFigures {
    /// Cone samples per pixel of the picture; at half resolution each traced pixel counts for four.
    pub samples_per_pixel: f32,
    /// The number of frames in the mean of a pixel's light, averaged over the pixels with a
    /// surface. `None` without [`TraceSettings::temporal`](lumivox::TraceSettings::temporal), or if
    /// there is no surface.
    pub history_frames: Option<f32>,
}

impl Renderer {
    /// Figures of the last frame; sums them up on the GPU and reads them back. `None` before the
    /// first frame, or if it had no cones.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn trace_figures(&mut self) -> Result<Option<TraceFigures>, RenderError> {
        let Self { gpu, gi, scene, settings, passes, .. } = self;
        let is_of_voxels = settings.view.is_of_voxels() || settings.shown_look().is_some();
        if is_of_voxels
            || !settings.view.needs_cones(settings.bounces)
            || self.targets.accumulate.frames() == 0
        {
            return Ok(None);
        }
        if passes.figures.is_none() {
            passes.figures = Some(FiguresPass::new(&gpu.pipelines, &passes.shaders)?);
            compile(gpu, (gi, &scene.geometry), settings, &mut |_| {}).await?;
        }
        let Self { gpu, passes, targets, .. } = self;
        let Some(pass) = &passes.figures else { return Ok(None) };
        let mut recorder = lumivox::gpu::Recorder::new(&gpu.device, &gpu.queue);
        let sums = pass.record(&mut recorder, &targets.view, passes.composite.no_records());
        recorder.submit();
        let words: Vec<u32> = read_buffer(&gpu.device, &gpu.queue, sums, 0..12).await?;
        gpu.check("adding up figures of a frame")?;
        let sums = Sums::new(&words, targets.view.size());
        let is_known = targets.view.is_temporal() && sums.known > 0;
        Ok(Some(TraceFigures {
            samples_per_pixel: sums.samples as f32 / sums.pixels as f32,
            history_frames: is_known.then(|| sums.frames as f32 / sums.known as f32),
        }))
    }
}
