//! Frames of a session: rendering them, showing them on the canvas, reading them back.

use glam::UVec2;
use lumivox::gpu::Timing;
use lumivox_render::{RenderSettings, View};
use web_time::Instant;

use super::{Session, no_scene};
use crate::beside::Beside;
use crate::error::{Code, WebError};
use crate::listener::Listener;
use crate::types::{FrameReport, StageMs};

impl Session {
    /// Renders one more frame and shows it.
    ///
    /// # Errors
    /// When a change is refused, or the device fails.
    pub async fn render(&mut self) -> Result<FrameReport, WebError> {
        let start = Instant::now();
        self.advance_time()?;
        let is_coarse = self.console.explorer.pacing.is_coarse();
        let size = self.console.explorer.pacing.next_size(self.full_size);
        self.fit(size, &Listener::new(None)).await?;
        let is_changing = is_coarse || self.console.explorer.playback().is_playing;
        let is_first = self.console.explorer.renderer().is_none();
        let is_complete = match self.beside.take() {
            None => !self.render_view(self.view).await?,
            Some(mut beside) => {
                let result = beside.advance(self, is_changing).await;
                // If the right side can no longer be shown, the picture continues without it.
                let is_refused = result.as_ref().is_err_and(|error| error.code == Code::Value);
                self.beside = Some(beside).filter(|_| !is_refused);
                result?
            }
        };
        self.show()?;
        let gpu = self.console.explorer.gpu().clone();
        gpu.finished("showing a picture").await?;
        if !is_complete {
            self.frame_ms = start.elapsed().as_secs_f64() * 1000.0;
            if !is_first {
                self.console.explorer.pacing.note_frame(start.elapsed());
            }
        }
        let stages = self.stages();
        let is_watched = self.console.explorer.settings().timing != Timing::Off;
        let figures = match self.console.explorer.renderer_mut().filter(|_| is_watched) {
            Some(renderer) => renderer.trace_figures().await?,
            None => None,
        };
        let pacing = self.console.explorer.pacing;
        let renderer = self.console.explorer.renderer();
        Ok(FrameReport {
            frame: renderer.map_or(0, lumivox_render::Renderer::frame_count),
            frames: self.console.explorer.settings().frames,
            complete: is_complete && !is_coarse && !self.console.explorer.changes_by_itself(),
            frame_ms: self.frame_ms,
            budget_ms: pacing.budget_ms,
            scale: pacing.scale(),
            samples_per_pixel: figures.map(|figures| figures.samples_per_pixel),
            history_frames: figures.and_then(|figures| figures.history_frames),
            camera: self.console.explorer.follows_camera().then(|| self.camera()),
            time_s: self
                .console
                .explorer
                .playback()
                .animation
                .map(|_| self.console.explorer.playback().time_s),
            stages,
            emission_alone: self.is_emission_alone,
            undo: self.console.explorer.undoable().map(str::to_owned),
            redo: self.console.explorer.redoable().map(str::to_owned),
            warning: self.meter.warning().map(|warning| warning.to_string()),
            reference_samples: self.beside.as_ref().and_then(Beside::samples),
        })
    }

    /// Advances animations; restarts metering and the right side.
    fn advance_time(&mut self) -> Result<(), WebError> {
        if self.console.explorer.tick_clock()? {
            self.meter.start_again();
            if let Some(beside) = &mut self.beside {
                beside.scene_changed();
            }
        }
        if self.console.explorer.playback().is_playing {
            self.picker = None;
            self.forget_truth();
        }
        Ok(())
    }

    /// Renders one more frame of a view, drawn for the screen; returns `false` if none was left.
    pub(crate) async fn render_view(&mut self, view: View) -> Result<bool, WebError> {
        if self.console.explorer.settings().view != view {
            let asked = RenderSettings { view, ..self.console.explorer.settings().clone() };
            self.console.explorer.set_settings(asked)?;
        }
        let explorer = &mut self.console.explorer;
        let has_rendered = explorer.frame(&mut |_| {}).await?;
        if explorer.renderer().is_none() {
            return Ok(false);
        }
        self.stops = if view != self.view {
            self.meter.beside(explorer, self.view).await?
        } else if explorer.pacing.is_first() {
            self.meter.follow_first(explorer).await?;
            self.meter.stops()
        } else {
            // The page shows the warning of the report.
            self.meter.follow(explorer).await?;
            self.meter.stops()
        };
        if let Some(renderer) = explorer.renderer_mut() {
            renderer.draw_screen(self.stops).await?;
        }
        Ok(has_rendered)
    }

    fn stages(&mut self) -> Vec<StageMs> {
        let mut stages: Vec<StageMs> = Vec::new();
        for time in self.console.explorer.take_stage_times() {
            let ms = time.duration.as_secs_f64() * 1000.0;
            match stages.iter_mut().find(|stage| stage.name == time.stage) {
                Some(stage) => stage.ms += ms,
                None => stages.push(StageMs { name: time.stage.to_owned(), ms }),
            }
        }
        stages
    }

    /// Draws the pictures on the canvas.
    fn show(&self) -> Result<(), WebError> {
        let Some(renderer) = self.console.explorer.renderer() else { return Ok(()) };
        let beside = self.beside.as_ref();
        let left = beside.and_then(Beside::left).unwrap_or(renderer.screen_texture());
        let right = beside.and_then(|beside| Some((beside.texture()?, beside.at)));
        self.presenter.show(self.console.explorer.gpu(), left, right)
    }

    /// The pixels of the canvas: width, height and four bytes a pixel, row by row from the top.
    ///
    /// # Errors
    /// When there is no picture yet, or the device fails.
    pub async fn pixels(&mut self) -> Result<(UVec2, Vec<[u8; 4]>), WebError> {
        let size = self.console.explorer.settings().size;
        let mut pixels = match self.beside.as_ref().and_then(Beside::left_pixels) {
            Some(pixels) => pixels.to_vec(),
            None => self.screen().await?,
        };
        if let Some((right, at)) = self.beside.as_ref().and_then(Beside::right_pixels) {
            let first = (at.clamp(0.0, 1.0) * size.x as f32) as usize;
            let width = size.x as usize;
            for (row, other) in pixels.chunks_exact_mut(width).zip(right.chunks_exact(width)) {
                row[first..].copy_from_slice(&other[first..]);
            }
        }
        Ok((size, pixels))
    }

    /// The picture of the explorer's view, read back.
    pub(crate) async fn screen(&mut self) -> Result<Vec<[u8; 4]>, WebError> {
        let renderer = self.console.explorer.renderer_mut().ok_or_else(no_scene)?;
        Ok(renderer.screen(self.stops).await?)
    }
}
