//! Rendering frame by frame, and publishing pictures.

use std::sync::Arc;
use std::time::Instant;

use glam::{UVec2, Vec2};
use lumivox::gpu::Timing;
use lumivox_explorer::{ExposureMeter, Side, SplitSchedule, first_look};
use lumivox_render::{
    Exposure, Picture, RenderProgress, RenderSettings, Renderer, TraceFigures, View,
};

use super::Worker;
use super::totals::FrameLog;
use crate::light::REMEDY;
use crate::progress::words;
use crate::window::jobs::Traced;
use crate::window::model::{Comparand, LightAt, LogKind, RENDERING};
use crate::window::screen::{Pixels, Screen, Shown};

/// State of the pictures on the screen and of the frame that is next.
pub struct Pictures {
    /// The picture's size at rest.
    full_size: UVec2,
    pub meter: ExposureMeter,
    pub comparand: Comparand,
    pub screen: Screen,
    split: SplitSchedule,
    /// `true` if the published picture shows the current state.
    is_current: bool,
    /// The number of the last picture.
    serial: u64,
    /// The number of the newest picture that the window shows.
    on_screen: u64,
    /// `true` after rendering has failed; nothing is rendered until something changes.
    pub has_failed: bool,
    /// Number of devices lost since the last frame.
    pub losses: u32,
    /// The place to measure the light at, if requested.
    pub probe: Option<Vec2>,
    pub times: FrameLog,
    /// Cone samples and length of the history of the last frame; `None` while the panel that shows
    /// them is closed.
    pub figures: Option<TraceFigures>,
}

impl Pictures {
    /// The initial state, with this size.
    pub fn new(full_size: UVec2) -> Self {
        Self {
            full_size,
            meter: ExposureMeter::default(),
            comparand: Comparand::default(),
            screen: Screen::default(),
            split: SplitSchedule::default(),
            is_current: false,
            serial: 0,
            on_screen: 0,
            has_failed: false,
            losses: 0,
            probe: None,
            times: FrameLog::default(),
            figures: None,
        }
    }

    /// The picture's size at rest.
    pub fn full_size(&self) -> UVec2 {
        self.full_size
    }

    /// Sets the picture's size at rest.
    pub fn set_full_size(&mut self, size: UVec2) {
        self.full_size = size.max(UVec2::ONE);
    }

    fn start_again(&mut self) {
        self.meter.start_again();
        self.has_failed = false;
        self.show_again();
    }

    /// Publishes the current pictures again.
    pub fn show_again(&mut self) {
        self.split.start_again();
        self.is_current = false;
    }

    /// Sets the number of the newest picture that the window shows.
    pub fn set_on_screen(&mut self, serial: u64) {
        self.on_screen = serial;
    }

    fn next_serial(&mut self) -> u64 {
        self.serial += 1;
        self.serial
    }
}

impl Worker {
    /// Whether the window shows the last picture, and no reference is being traced.
    pub(super) fn is_screen_current(&self) -> bool {
        !self.jobs.is_tracing() && self.pictures.on_screen >= self.publisher.shared().newest()
    }

    /// Restarts the picture after a change.
    pub(super) fn start_again(&mut self) {
        self.pictures.start_again();
        self.publisher.change(|published| {
            if let Some(doing) = &mut published.doing {
                doing.since = Instant::now();
            }
        });
        self.check_reference();
    }

    /// Drops the reference if it no longer matches the explorer.
    fn check_reference(&mut self) {
        if self.jobs.is_reference_old(&self.console.explorer, self.pictures.full_size) {
            self.forget_reference();
        }
    }

    /// Sets the size of the explorer's pictures, up to the device's limit.
    pub(super) fn set_size(&mut self, size: UVec2) {
        let explorer = &mut self.console.explorer;
        if explorer.settings().size != size {
            let most = explorer.gpu().device.limits().max_texture_dimension_2d;
            let settings = RenderSettings {
                size: size.min(UVec2::splat(most)),
                ..explorer.settings().clone()
            };
            // Cannot fail: the size is within the limit.
            let _ = explorer.set_settings(settings);
        }
    }

    /// Renders the next frame; returns whether there is more to do.
    pub(super) fn render_some(&mut self) -> anyhow::Result<bool> {
        if self.pictures.has_failed || self.console.explorer.scene().is_none() {
            self.lines.frames_are_over();
            return Ok(false);
        }
        // The window may already have noticed the loss.
        anyhow::ensure!(!self.console.explorer.gpu().is_lost(), "the GPU was lost");
        self.advance_time()?;
        // Frames on demand need no first look.
        let explorer = &mut self.console.explorer;
        if explorer.is_single_frame {
            explorer.pacing.first_shown();
        }
        let is_coarse = explorer.pacing.is_coarse();
        let size = explorer.pacing.next_size(self.pictures.full_size);
        self.set_size(size);
        if self.console.explorer.is_single_frame {
            return self.show_what_is_there();
        }
        // A coarse picture is followed by a full one once the scene is at rest.
        let is_changing = is_coarse || self.console.explorer.playback().is_playing;
        let Comparand::View(view) = self.pictures.comparand else {
            let has_rendered = self.render_frame()?;
            if let Comparand::Reference(samples) = self.pictures.comparand
                && !has_rendered
                && !self.console.explorer.pacing.is_coarse()
            {
                self.trace(samples);
            }
            return Ok(has_rendered || is_changing);
        };
        let has_rendered = match self.pictures.split.next() {
            Some(Side::Left) => self.render_frame()?,
            Some(Side::Right) => self.render_other(view)?,
            None => {
                self.lines.frames_are_over();
                return Ok(false);
            }
        };
        self.pictures.split.advance(has_rendered, is_changing);
        Ok(self.pictures.split.next().is_some())
    }

    /// Advances animations and updates voxels.
    fn advance_time(&mut self) -> anyhow::Result<()> {
        if self.console.explorer.tick_clock()? {
            self.pictures.meter.start_again();
            self.pictures.split.scene_changed();
        }
        if self.console.explorer.playback().is_playing {
            self.session.view.forget();
            self.check_reference();
        }
        Ok(())
    }

    /// Renders the next frame of the picture; returns whether there was one.
    fn render_frame(&mut self) -> anyhow::Result<bool> {
        let start = Instant::now();
        let is_first = self.console.explorer.renderer().is_none();
        self.publisher.begin(RENDERING.to_owned());
        let publisher = self.publisher.clone();
        // Report progress: voxels, light and pipelines may take long.
        let mut tell = |step: RenderProgress| {
            let words = if step.done < step.total { words(step.stage) } else { RENDERING };
            publisher.begin(words.to_owned());
        };
        let explorer = &mut self.console.explorer;
        let asked = explorer.settings().clone();
        if explorer.pacing.is_first() {
            // If the settings of the first look are refused, render without them.
            let _ = explorer.set_settings(first_look(&asked, explorer.scene()));
        }
        let rendered = pollster::block_on(explorer.frame(&mut tell));
        explorer.set_settings(asked)?;
        let has_rendered = rendered?;
        if has_rendered {
            self.pictures.losses = 0;
            self.lines.frame_rendered();
            let elapsed = start.elapsed();
            if !is_first {
                explorer.pacing.note_frame(elapsed);
            }
            self.pictures.times.add(elapsed, &explorer.take_stage_times(), is_first);
            let is_watched = explorer.settings().timing != Timing::Off;
            self.pictures.figures = match explorer.renderer_mut().filter(|_| is_watched) {
                Some(renderer) => pollster::block_on(renderer.trace_figures())?,
                None => None,
            };
        } else {
            self.lines.frames_are_over();
        }
        if has_rendered || !self.pictures.is_current {
            self.show()?;
        }
        Ok(has_rendered)
    }

    /// Publishes frames that commands have rendered.
    fn show_what_is_there(&mut self) -> anyhow::Result<bool> {
        self.lines.frames_are_over();
        let explorer = &mut self.console.explorer;
        if explorer.renderer().is_none() {
            self.render_frame()?;
        } else if !self.pictures.is_current {
            pollster::block_on(explorer.update(&mut |_| {}))?;
            if self.console.explorer.renderer().is_some_and(|renderer| renderer.frame_count() > 0) {
                self.show()?;
            }
        }
        Ok(false)
    }

    /// Publishes the picture of the frames so far.
    fn show(&mut self) -> anyhow::Result<()> {
        let (explorer, pictures) = (&self.console.explorer, &mut self.pictures);
        if explorer.pacing.is_first() {
            pollster::block_on(pictures.meter.follow_first(explorer))?;
        } else if let Some(warning) = pollster::block_on(pictures.meter.follow(explorer))? {
            tracing::warn!("{warning}: {REMEDY}");
        }
        self.show_reference()?;
        self.pictures.is_current = true;
        let shown = self.shown(self.pictures.meter.stops())?;
        self.console.explorer.pacing.first_shown();
        self.publisher.change(|published| published.picture = shown);
        self.publish();
        Ok(())
    }

    /// Measures the light at the probed place, unless another view is shown, whose frames alternate
    /// with the picture's.
    pub(super) fn measure_light(&mut self) {
        let Some(at) = self.pictures.probe.take() else { return };
        let light = match (self.console.explorer.renderer(), self.pictures.comparand) {
            (None, _) | (_, Comparand::View(_)) => None,
            (Some(renderer), _) => {
                let size = renderer.settings().size;
                let pixel = (at * size.as_vec2()).as_uvec2().min(size - UVec2::ONE);
                // Ignore errors: the next frame notices a lost device.
                pollster::block_on(renderer.photometry(pixel)).ok().flatten()
            }
        };
        self.publisher.publish(|published| published.light = Some(LightAt { at, light }));
    }

    fn shown(&mut self, stops: f32) -> anyhow::Result<Option<Arc<Shown>>> {
        let explorer = &mut self.console.explorer;
        let (serial, size) = (self.pictures.next_serial(), explorer.settings().size);
        let frames = explorer.renderer().map_or(0, Renderer::frame_count);
        let pixels = pollster::block_on(self.pictures.screen.picture(explorer, stops))?;
        Ok(pixels.map(|pixels| Arc::new(Shown { serial, size, pixels, frames })))
    }

    /// Renders and publishes the next frame of another view; returns whether there was one. Ends
    /// the comparison if the explorer rejects the view.
    fn render_other(&mut self, view: View) -> anyhow::Result<bool> {
        let settings = self.console.explorer.settings().clone();
        let other = RenderSettings { view, ..settings.clone() };
        let done = match self.console.explorer.set_settings(other) {
            Ok(()) => self.render_frame_of_other(settings.view),
            Err(error) => Err(error.into()),
        };
        // Cannot fail: these are the previous settings.
        let _ = self.console.explorer.set_settings(settings);
        match done {
            Err(error) if !self.has_lost_device() => {
                self.messages.fail(&error);
                self.compare(Comparand::Nothing);
                self.publish();
                Ok(false)
            }
            done => done,
        }
    }

    fn render_frame_of_other(&mut self, first: View) -> anyhow::Result<bool> {
        let explorer = &mut self.console.explorer;
        if !pollster::block_on(explorer.frame(&mut |_| {}))? {
            return Ok(false);
        }
        // Discard the other view's times.
        let _ = explorer.take_stage_times();
        let stops = pollster::block_on(self.pictures.meter.beside(explorer, first))?;
        let shown = self.shown(stops)?;
        self.publisher.publish(|published| published.other = shown);
        Ok(true)
    }

    /// Starts tracing the reference once the picture is complete.
    fn trace(&mut self, samples: u32) {
        if self.jobs.trace(&self.console.explorer, samples) {
            self.publisher.change(|published| published.other = None);
        }
    }

    /// Applies a result of tracing the reference.
    pub(super) fn take_reference(&mut self, traced: Traced) {
        let is_last = traced.is_last;
        match self.jobs.take_traced(traced) {
            None => {}
            Some(Ok(())) => {
                let samples = self.jobs.reference.as_ref().map_or(0, |reference| reference.samples);
                if is_last {
                    let text = format!("the reference is complete: {samples} samples a pixel");
                    self.messages.log.add(LogKind::Note, &text);
                }
                if let Err(error) = self.show_reference() {
                    self.messages.fail(&error.context("the reference cannot be shown"));
                }
            }
            Some(Err(error)) => self.messages.fail(&error.context("the reference failed")),
        }
    }

    /// Publishes the reference with the picture's exposure and tone curve, unless it already was.
    fn show_reference(&mut self) -> anyhow::Result<()> {
        let Some(reference) = &mut self.jobs.reference else { return Ok(()) };
        let explorer = &self.console.explorer;
        let look = (self.pictures.meter.stops(), explorer.settings().tone_map);
        if reference.shown == Some(look) {
            return Ok(());
        }
        reference.shown = Some(look);
        let (hdr, size, frames) = (reference.hdr.clone(), reference.size, reference.samples);
        let (exposure, curve) = (Exposure::Stops(look.0), look.1);
        let picture = Picture::develop(explorer.gpu(), size, hdr, exposure, curve);
        let picture = pollster::block_on(picture)?;
        let serial = self.pictures.next_serial();
        let shown = Shown { serial, size, pixels: Pixels::InMemory(picture.ldr), frames };
        self.publisher.change(|published| published.other = Some(Arc::new(shown)));
        Ok(())
    }
}
