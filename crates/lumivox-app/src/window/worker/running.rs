//! Running lines, and handling their effects and errors.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use lumivox_console::{Effect, LineInfo, ProgressListener, Reply};
use lumivox_render::RenderProgress;

use super::Worker;
use crate::window::lines::{Line, Origin};
use crate::window::model::{Comparand, Job, JobModel, LogKind};

/// Interval at which long commands report their progress.
const TELL_EVERY: Duration = Duration::from_millis(100);

/// A line's beginning, short enough for the status bar.
fn shortened(line: &str) -> String {
    const MOST: usize = 40;
    let mut letters = line.trim().chars();
    let start: String = letters.by_ref().take(MOST).collect();
    if letters.next().is_some() { format!("{start} ...") } else { start }
}

impl Worker {
    /// Runs lines until one has to wait; returns whether any ran.
    pub(super) fn run_lines(&mut self) -> bool {
        let mut has_run = false;
        // Start no line after a request to quit or to stop.
        while !self.is_over && !self.publisher.shared().is_stopped() {
            let Some(line) = self.lines.next(self.jobs.is_opening()) else { break };
            if !has_run {
                self.set_size(self.pictures.full_size());
            }
            has_run = true;
            if self.waits_for_frames(&line) {
                self.lines.run_after(line, self.console.explorer.settings().frames);
                self.start_again();
                continue;
            }
            self.run_line(&line);
            self.lines.finish(&line);
        }
        has_run
    }

    /// Whether frames must be rendered before a line can run.
    fn waits_for_frames(&mut self, line: &Line) -> bool {
        let explorer = &self.console.explorer;
        let is_prepared = self.lines.take_prepared();
        if is_prepared || explorer.is_single_frame || explorer.playback().is_playing {
            return false;
        }
        explorer.scene().is_some()
            && !self.pictures.has_failed
            && LineInfo::of(&line.text).needs_all_frames
    }

    fn run_line(&mut self, line: &Line) {
        if line.text.trim().is_empty() {
            return;
        }
        self.messages.log.add_command(line);
        if self.lines.begins_gesture(line) {
            self.console.explorer.end_gesture();
        }
        self.publisher.begin(format!("doing `{}`", shortened(&line.text)));
        let reply = match self.run_own(&line.text) {
            Some(done) => done.map(Reply::say),
            None => pollster::block_on(self.console.run_on(&line.text)),
        };
        match reply {
            Ok(reply) => {
                self.messages.log.add(LogKind::Reply, &reply.text);
                self.follow(reply.effect, line.origin);
            }
            Err(error) => {
                self.messages.fail(&error);
                if line.origin == Origin::Script {
                    self.lines.abandon();
                }
            }
        }
        self.pictures.set_full_size(self.console.explorer.settings().size);
        self.note_edits(&line.text);
        self.start_again();
    }

    fn follow(&mut self, effect: Effect, origin: Origin) {
        match effect {
            Effect::Nothing => {}
            Effect::Open(opening) => {
                // Drop the rest of a script that waits for the scene being replaced.
                if self.jobs.is_loading() && origin != Origin::Script {
                    self.lines.abandon();
                }
                self.jobs.load(*opening, false);
            }
            Effect::Wait(frames) => self.lines.wait_for(frames),
            Effect::Run(lines) => {
                if let Err(error) = self.lines.interpose(lines) {
                    self.messages.fail(&error);
                }
            }
            Effect::Quit => self.is_over = true,
        }
    }

    /// Cancels a job; all jobs if `which` is `None`.
    pub(super) fn cancel(&mut self, which: Option<Job>) {
        self.publisher.shared().go_on();
        let is_meant = |job: Job| which.is_none_or(|which| which == job);
        if is_meant(Job::Loading)
            && let Some(loading) = self.jobs.take_loading(None)
        {
            self.lines.abandon();
            let text = format!("no longer waiting for {}", loading.title);
            self.messages.log.add(LogKind::Note, &text);
        }
        if is_meant(Job::Lines) && self.lines.are_under_way() {
            self.lines.abandon();
            self.messages.log.add(LogKind::Note, "no longer waiting for frames");
        }
        if is_meant(Job::Reference) && self.jobs.is_tracing() {
            self.compare(Comparand::Nothing);
            self.messages.log.add(LogKind::Note, "the reference is stopped");
        }
        if !self.jobs.is_loading() && self.jobs.take_change() {
            self.reload();
        }
    }

    /// A listener that publishes the progress of long commands, and stops them on request.
    pub(super) fn progress_listener(&self) -> Box<dyn ProgressListener> {
        let publisher = self.publisher.clone();
        let mut told = Instant::now();
        Box::new(move |step: RenderProgress| {
            if told.elapsed() >= TELL_EVERY {
                told = Instant::now();
                let steps = if step.total > 0 {
                    format!(" {} of {}", step.done, step.total)
                } else {
                    String::new()
                };
                let job = JobModel {
                    words: format!("{}{steps}", crate::progress::words(step.stage)),
                    since: None,
                    share: (step.total > 0).then(|| step.done as f32 / step.total as f32),
                    cancel: Some(Job::Command),
                };
                publisher.publish(|published| published.under_way(job));
            }
            if publisher.shared().is_stopped() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        })
    }
}
