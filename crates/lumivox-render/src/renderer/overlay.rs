//! The overlay: renders its frames and blends them over the picture.

use lumivox::gpu::Recorder;

use super::Renderer;
use super::samples::{camera_view, samples_before};
use crate::RenderError;
use crate::passes::overlay::{OverlayPass, OverlayView, Shown};
use crate::picture::tone_map::Encoding;

impl Renderer {
    /// The number of frames in the mean of the current overlay; 0 if the picture has no frames.
    pub fn overlay_frame_count(&self) -> u32 {
        if self.frame_count() == 0 {
            return 0;
        }
        self.targets.overlay.as_ref().map_or(0, |pass| pass.frames(&self.shown()))
    }

    /// Renders one more frame of only the overlay, for a picture that has all of its frames. Does
    /// nothing if the overlay is off, or before the picture's first frame.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render_overlay_frame(&mut self) -> Result<(), RenderError> {
        if !self.settings.overlay.is_on() || self.frame_count() == 0 {
            return Ok(());
        }
        let frame = self.overlay_frame_count();
        let size = self.settings.size;
        let jitter = self.first_in_pixel(samples_before(frame));
        let seen = camera_view(&self.camera, size, (Some(frame), jitter));
        self.targets.view.set_camera(&self.gpu.queue, seen);
        let timing = self.settings.timing;
        let mut recorder = Recorder::with_timing(&self.gpu.device, &self.gpu.queue, timing);
        if self.settings.overlay.needs_depth() {
            self.record_surfaces(&mut recorder, frame);
        }
        self.draw_overlay(&mut recorder)?;
        self.times.add(recorder.finish().await?);
        self.gpu.check("drawing the overlay")
    }

    /// Renders as many frames of the overlay as the picture has.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn complete_overlay(&mut self) -> Result<(), RenderError> {
        // Without a picture there is nothing to blend with.
        let is_on = self.settings.overlay.is_on() && self.frame_count() > 0;
        while is_on && self.overlay_frame_count() < self.settings.frames {
            self.render_overlay_frame().await?;
            self.gpu.wait("drawing the overlay")?;
        }
        Ok(())
    }

    /// Adds the overlay to the frame with this index in the picture, with the same camera.
    pub(super) fn record_overlay(
        &mut self,
        recorder: &mut Recorder,
        frame: u32,
    ) -> Result<(), RenderError> {
        // The overlay restarts whenever the picture does.
        if let Some(pass) = self.targets.overlay.as_mut().filter(|_| frame == 0) {
            pass.reset();
        }
        if !self.settings.overlay.is_on() {
            return Ok(());
        }
        // Views of voxels do not fill the G-buffer.
        if self.settings.view.is_of_voxels() && self.settings.overlay.needs_depth() {
            self.record_surfaces(recorder, frame);
        }
        self.draw_overlay(recorder)
    }

    /// Tone maps the mean for the screen, with the overlay if it has frames.
    pub(super) fn record_screen(&self, recorder: &mut Recorder, encoding: Encoding) {
        let picture = self.targets.accumulate.mean();
        let tone_map = &self.targets.tone_map;
        let is_on = self.settings.overlay.is_on() && self.overlay_frame_count() > 0;
        match self.targets.overlay.as_ref().filter(|_| is_on) {
            Some(pass) => pass.blend(recorder, tone_map, picture, encoding),
            None => tone_map.record(recorder, picture, encoding),
        }
    }

    fn record_surfaces(&mut self, recorder: &mut Recorder, frame: u32) {
        if self.settings.shown_look().is_some() && !self.settings.view.is_of_voxels() {
            // The overlay's samples see other points of the surfaces. The picture's mean is not
            // affected.
            self.record_look(recorder);
            return;
        }
        recorder.stage("G-buffer");
        let shown = (&self.targets.view, samples_before(frame));
        self.passes.gbuffer.record(recorder, &self.scene, &self.targets.gbuffer_textures, shown);
    }

    fn draw_overlay(&mut self, recorder: &mut Recorder) -> Result<(), RenderError> {
        let shown = self.shown();
        let Self { gpu, gi, scene, settings, passes, targets, .. } = self;
        let pass = match &mut targets.overlay {
            Some(pass) => pass,
            slot => {
                let pass = OverlayPass::new(&gpu.pipelines, &passes.shaders, settings.size)?;
                targets.bytes += pass.bytes;
                slot.insert(pass)
            }
        };
        let (view, surfaces) = (&targets.view, &targets.gbuffer_textures);
        let seen = OverlayView { view, scene, gi, surfaces };
        Ok(pass.record(recorder, &shown, seen)?)
    }

    fn shown(&self) -> Shown {
        let Self { settings, .. } = self;
        let mut overlay = settings.overlay.clone();
        // Views of voxels have no surfaces to hide.
        overlay.hides_surfaces &= !settings.view.is_of_voxels();
        let voxel_level = settings.voxel_level.min(self.gi.grid().level_count() - 1);
        Shown { overlay, voxel_level }
    }
}
