//! Rendering frame by frame, and publishing pictures.
//!
//! With another view beside the picture the two take turns. After a change each gets one frame, so that both halves show
//! the same moment, then the first is completed, then the second, and both stand until something changes again. Frames
//! that alternated all the time would start their means anew each time, and neither picture would get better.

use std::sync::Arc;
use std::time::{Duration, Instant};

use glam::UVec2;
use lumivox_explorer::{Revoxelize, first_look};
use lumivox_render::{Exposure, Picture, Progress, RenderSettings, View};

use super::Worker;
use super::running::begin;
use crate::commands::light::REMEDY;
use crate::progress::words;
use crate::window::jobs::{self, ReferenceKey, Traced, Tracing};
use crate::window::model::{
    Comparand, FrameTime, JobModel, KEPT_FRAMES, LightAt, LogKind, RENDERING, Shown,
};

/// Whose turn it is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Turn {
    /// One frame of the picture.
    #[default]
    First,
    /// One frame of what is beside it.
    FirstOther,
    /// The rest of the picture.
    Rest,
    /// All of what is beside it.
    Other,
    /// Nobody's: all is there.
    Over,
}

impl Worker {
    /// Something has changed: what is shown is no longer true.
    pub(super) fn start_again(&mut self) {
        self.turn = Turn::First;
        self.has_failed = false;
        self.pace.is_current = false;
        self.shared.change(|published| {
            if let Some(doing) = &mut published.doing {
                doing.since = Instant::now();
            }
        });
        self.check_reference();
    }

    /// Gives a reference up that is of another state.
    fn check_reference(&mut self) {
        let explorer = &self.console.explorer;
        let is_of = |tracing: &Tracing| {
            explorer
                .scene()
                .is_some_and(|scene| tracing.key.is_of(scene, explorer.camera(), self.full_size))
        };
        if self.tracing.as_ref().is_some_and(|tracing| !is_of(tracing)) {
            self.forget_reference();
        }
    }

    /// Lets pictures have a size.
    pub(super) fn set_size(&mut self, size: UVec2) {
        let explorer = &mut self.console.explorer;
        if explorer.size() != size {
            let most = explorer.gpu().device.limits().max_texture_dimension_2d;
            let settings = RenderSettings {
                size: size.min(UVec2::splat(most)),
                ..explorer.settings().clone()
            };
            // Sizes within the limit are always allowed.
            let _ = explorer.set_settings(settings);
        }
    }

    /// Renders a frame of what is next; whether there is more to do.
    pub(super) fn render_some(&mut self) -> anyhow::Result<bool> {
        if self.has_failed || self.console.explorer.scene().is_none() {
            self.frames_to_wait = 0;
            return Ok(false);
        }
        self.let_time_go()?;
        // Frames that come on demand are those of the picture.
        self.pace.is_first &= !self.console.explorer.is_single_frame;
        let was_moving = self.pace.divisor();
        self.set_size((self.full_size / was_moving).max(UVec2::ONE));
        let other = match self.comparand {
            Comparand::View(view) => Some(view),
            Comparand::Nothing | Comparand::Reference(_) => None,
        };
        if self.console.explorer.is_single_frame {
            return self.show_what_is_there();
        }
        match (other, self.turn) {
            (None, _) => {
                let more = self.render_frame()?;
                if !more && self.pace.divisor() == 1 {
                    self.keep_reference();
                }
                // A coarse picture waits for the camera to come to rest.
                Ok(more || was_moving > 1 || self.console.explorer.playback().is_playing)
            }
            (Some(_), Turn::First) => {
                self.render_frame()?;
                self.turn = Turn::FirstOther;
                Ok(true)
            }
            (Some(view), Turn::FirstOther) => {
                self.render_other(view, 1)?;
                let goes_on = self.console.explorer.playback().is_playing || was_moving > 1;
                self.turn = if goes_on { Turn::First } else { Turn::Rest };
                Ok(true)
            }
            (Some(_), Turn::Rest) => {
                if !self.render_frame()? {
                    self.turn = Turn::Other;
                }
                Ok(true)
            }
            (Some(view), Turn::Other) => {
                if self.render_other(view, u32::MAX)? {
                    self.turn = Turn::Over;
                }
                Ok(self.turn != Turn::Over)
            }
            (Some(_), Turn::Over) => {
                self.frames_to_wait = 0;
                Ok(false)
            }
        }
    }

    /// Lets animations play and voxels follow.
    fn let_time_go(&mut self) -> anyhow::Result<()> {
        let now = Instant::now();
        let passed = now - std::mem::replace(&mut self.last_tick, now);
        let explorer = &mut self.console.explorer;
        // After a long sleep an animation goes on where it was.
        let passed_s = passed.as_secs_f32();
        explorer.tick(if explorer.playback().is_playing { passed_s.min(1.0) } else { passed_s })?;
        let is_playing = explorer.playback().is_playing;
        self.voxels_s += passed_s.min(if is_playing { 1.0 } else { f32::INFINITY });
        let are_due = match explorer.revoxelize {
            Revoxelize::WhenMoved | Revoxelize::WhenAsked => false,
            Revoxelize::Every(period_s) => self.voxels_s >= period_s,
            Revoxelize::EveryFrame => true,
        };
        if are_due {
            self.voxels_s = 0.0;
        }
        if is_playing {
            self.forget_scene();
            self.check_reference();
        }
        // Both halves have their frame of one moment before the next.
        if (is_playing || are_due) && matches!(self.turn, Turn::Rest | Turn::Other | Turn::Over) {
            self.turn = Turn::First;
        }
        Ok(())
    }

    /// One frame more of the picture; whether there was one to render.
    fn render_frame(&mut self) -> anyhow::Result<bool> {
        let start = Instant::now();
        let is_first = self.console.explorer.renderer().is_none();
        self.begin(RENDERING.to_owned());
        let (shared, wake) = (self.shared.clone(), self.wake.clone());
        // Voxels, light and pipelines take long enough to tell.
        let mut tell = |step: Progress| {
            let words = if step.done < step.total { words(step.stage) } else { RENDERING };
            begin(&shared, &wake, words.to_owned());
        };
        let explorer = &mut self.console.explorer;
        let asked = explorer.settings().clone();
        if self.pace.is_first {
            // Settings for a first look that are refused are done without.
            let _ = explorer.set_settings(first_look(&asked));
        }
        let rendered = pollster::block_on(explorer.frame(&mut tell));
        explorer.set_settings(asked)?;
        let has_rendered = rendered?;
        if has_rendered {
            self.losses = 0;
            self.frames_to_wait = self.frames_to_wait.saturating_sub(1);
            self.note_time(start.elapsed(), is_first);
        } else {
            self.frames_to_wait = 0;
        }
        if has_rendered || !self.pace.is_current {
            self.show()?;
        }
        Ok(has_rendered)
    }

    fn note_time(&mut self, elapsed: Duration, is_first: bool) {
        let explorer = &mut self.console.explorer;
        if explorer.size() == self.full_size && !is_first {
            self.pace.full_frame = elapsed;
        }
        let mut time = FrameTime { total_ms: elapsed.as_secs_f32() * 1e3, ..FrameTime::default() };
        let stages = explorer.take_stage_times();
        self.stage_totals.add(&stages);
        for stage in stages {
            time.add(stage.stage, stage.duration.as_secs_f32() * 1e3);
        }
        if self.frame_times.len() == KEPT_FRAMES {
            self.frame_times.pop_front();
        }
        if !is_first {
            self.frame_times.push_back(time);
        }
    }

    /// Shows frames that commands have rendered.
    fn show_what_is_there(&mut self) -> anyhow::Result<bool> {
        self.frames_to_wait = 0;
        let explorer = &mut self.console.explorer;
        if explorer.renderer().is_none() {
            self.render_frame()?;
        } else if !self.pace.is_current {
            pollster::block_on(explorer.update(&mut |_| {}))?;
            if self.console.explorer.renderer().is_some_and(|renderer| renderer.frame_count() > 0) {
                self.show()?;
            }
        }
        Ok(false)
    }

    /// Publishes the picture of the frames so far.
    fn show(&mut self) -> anyhow::Result<()> {
        let explorer = &mut self.console.explorer;
        let frames = explorer.renderer().map_or(0, lumivox_render::Renderer::frame_count);
        let is_last = frames >= explorer.settings().frames;
        if let Some(stops) = explorer.settings().exposure.fixed_stops() {
            self.pace.stops = stops;
        }
        if self.pace.is_due(frames, is_last) {
            let metering = pollster::block_on(explorer.meter())?;
            if self.pace.is_first {
                // The pictures of full size get warnings and a histogram of their own.
                self.pace.stops = metering.stops;
            } else if let Some(warning) = self.pace.measured(&metering) {
                tracing::warn!("{warning}: {REMEDY}");
            }
        }
        self.show_reference()?;
        self.pace.is_current = true;
        let shown = self.shown(self.pace.stops)?;
        self.pace.is_first = false;
        self.shared.change(|published| published.picture = shown);
        self.publish();
        Ok(())
    }

    /// Measures the light where somebody points. Beside another view, whose frames take turns with the picture's, there is
    /// nothing to be measured.
    pub(super) fn measure_light(&mut self) {
        let Some(at) = self.probe.take() else { return };
        let explorer = &self.console.explorer;
        let size = explorer.renderer().map(|renderer| renderer.settings().size);
        let light = match (size, self.comparand) {
            (None, _) | (_, Comparand::View(_)) => None,
            (Some(size), _) => {
                let pixel = (at * size.as_vec2()).as_uvec2().min(size - UVec2::ONE);
                // A device that is lost is noticed by the next frame.
                pollster::block_on(explorer.probe(pixel)).ok().flatten()
            }
        };
        self.shared.change(|published| published.light = Some(LightAt { at, light }));
        (self.wake)();
    }

    fn shown(&mut self, stops: f32) -> anyhow::Result<Option<Arc<Shown>>> {
        let explorer = &mut self.console.explorer;
        self.pace.serial += 1;
        let (serial, size) = (self.pace.serial, explorer.size());
        let frames = explorer.renderer().map_or(0, lumivox_render::Renderer::frame_count);
        let pixels = pollster::block_on(explorer.screen(stops))?;
        Ok(pixels.map(|pixels| Arc::new(Shown { serial, size, pixels, frames })))
    }

    /// Renders frames of another view and publishes them, until all of them are there (which is told) or somebody
    /// wants something.
    fn render_other(&mut self, view: View, most: u32) -> anyhow::Result<bool> {
        let settings = self.console.explorer.settings().clone();
        let other = RenderSettings { view, ..settings.clone() };
        let done = match self.console.explorer.set_settings(other) {
            Ok(()) => self.render_frames_of_other(settings.view, most),
            Err(error) => Err(error.into()),
        };
        // Not one that is refused: it was there before.
        let _ = self.console.explorer.set_settings(settings);
        // The picture itself goes on without it.
        match done {
            Err(error) if !self.console.explorer.gpu().is_lost() => {
                self.fail(&error);
                self.compare(Comparand::Nothing);
                self.publish();
                Ok(true)
            }
            done => done,
        }
    }

    fn render_frames_of_other(&mut self, first: View, most: u32) -> anyhow::Result<bool> {
        let is_light = |view: View| view.is_light();
        for _ in 0..most {
            if !pollster::block_on(self.console.explorer.frame(&mut |_| {}))? {
                return Ok(true);
            }
            // These are not times of the picture.
            let _ = self.console.explorer.take_stage_times();
            let view = self.console.explorer.settings().view;
            // Both are exposed alike where both are light.
            let stops = if is_light(first) && is_light(view) {
                self.pace.stops
            } else {
                pollster::block_on(self.console.explorer.meter())?.stops
            };
            let shown = self.shown(stops)?;
            self.shared.change(|published| published.other = shown);
            (self.wake)();
            if self.has_orders() {
                return Ok(false);
            }
        }
        Ok(true)
    }

    /// Starts the reference once the picture is complete, and gives up one of another state.
    fn keep_reference(&mut self) {
        let Comparand::Reference(samples) = self.comparand else { return };
        let explorer = &self.console.explorer;
        let Some(scene) = explorer.scene() else { return };
        let key = ReferenceKey::new(scene, explorer.camera(), explorer.settings(), samples);
        if self.tracing.as_ref().is_some_and(|tracing| tracing.key == key) {
            return;
        }
        let (gpu, scene) = (explorer.gpu().clone(), scene.clone());
        // The old one goes first: its memory and its time are for the new one.
        self.forget_reference();
        self.jobs += 1;
        self.tracing = Some(jobs::trace(self.jobs, gpu, scene, key, self.sender.clone()));
    }

    /// More of the reference is there.
    pub(super) fn take_reference(&mut self, traced: Traced) {
        let tracing = self.tracing.as_mut().filter(|tracing| tracing.number == traced.number);
        let Some(tracing) = tracing else { return };
        tracing.is_over = traced.is_last;
        match traced.result {
            Ok(reference) => {
                let samples = reference.samples;
                self.reference = Some(reference);
                if traced.is_last {
                    let text = format!("the reference is complete: {samples} samples a pixel");
                    self.log.add(LogKind::Note, &text);
                }
                if let Err(error) = self.show_reference() {
                    self.fail(&error.context("the reference cannot be shown"));
                }
            }
            Err(error) => {
                self.fail(&error.context("the reference failed"));
            }
        }
    }

    /// Publishes the reference, exposed and toned as the picture is, unless it is there like this already.
    fn show_reference(&mut self) -> anyhow::Result<()> {
        let Some(reference) = &mut self.reference else { return Ok(()) };
        let explorer = &self.console.explorer;
        let look = (self.pace.stops, explorer.settings().tone_map);
        if reference.shown == Some(look) {
            return Ok(());
        }
        reference.shown = Some(look);
        let (hdr, size, frames) = (reference.hdr.clone(), reference.size, reference.samples);
        let (exposure, curve) = (Exposure::Stops(look.0), look.1);
        let picture = Picture::develop(explorer.gpu(), size, hdr, exposure, curve);
        let picture = pollster::block_on(picture)?;
        self.pace.serial += 1;
        let shown = Shown { serial: self.pace.serial, size, pixels: picture.ldr, frames };
        self.shared.change(|published| published.other = Some(Arc::new(shown)));
        Ok(())
    }
}

impl super::Published {
    /// Tells how far a new scene is on the GPU.
    /// Tells what keeps the worker.
    pub(super) fn under_way(&mut self, job: JobModel) {
        let mut model = (*self.model).clone();
        model.jobs = vec![job];
        self.model = Arc::new(model);
    }
}
