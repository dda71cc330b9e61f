//! Lines: which is next, what it does, and what becomes of the rest when something goes wrong.

use std::ops::ControlFlow;
use std::time::{Duration, Instant};

use lumivox_console::{Effect, Hear, Queue, Reply};
use lumivox_render::Progress;

use super::{Shared, Wake, Worker};
use crate::window::lines::{self, Line, Origin};
use crate::window::model::{Doing, Job, JobModel, LogKind};

/// A command that takes longer tells how far it is, this often.
const TELL_EVERY: Duration = Duration::from_millis(100);
/// Commands that render all frames of the picture: the frames come first, one by one, while the window goes on.
const OF_WHOLE_PICTURES: [&str; 2] = ["screenshot", "compare"];

/// A line's beginning, as much as there is room for beside other words.
fn shortened(line: &str) -> String {
    const MOST: usize = 40;
    let mut letters = line.trim().chars();
    let start: String = letters.by_ref().take(MOST).collect();
    if letters.next().is_some() { format!("{start} ...") } else { start }
}

/// Tells what begins, unless it is still the same.
pub(super) fn begin(shared: &Shared, wake: &Wake, words: String) {
    let mut is_new = false;
    shared.change(|published| {
        is_new = published.doing.as_ref().is_none_or(|doing| doing.words != words);
        if is_new {
            published.doing = Some(Doing { words, since: Instant::now() });
        }
    });
    if is_new {
        wake();
    }
}

impl Worker {
    /// Runs lines until one has to wait for something; whether there was one.
    pub(super) fn run_lines(&mut self) -> bool {
        let mut has_run = false;
        // What somebody wants to end or to break off is not begun.
        while !self.is_over && !self.shared.is_stopped() {
            let Some(line) = self.next_line() else { break };
            if !has_run {
                self.set_size(self.full_size);
            }
            has_run = true;
            if self.waits_for_frames(&line) {
                self.pending = Some(line);
                continue;
            }
            self.run_line(&line);
            self.lines_done = self.lines_done.max(line.serial);
        }
        has_run
    }

    /// The next line that need not wait. While a scene is read, lines of the terminal and of scripts wait for it; while
    /// frames are waited for, all but those of the panels do.
    fn next_line(&mut self) -> Option<Line> {
        let is_loading = self.loading.as_ref().is_some_and(|loading| !loading.is_reload);
        let is_waiting = self.frames_to_wait > 0;
        if !is_loading && !is_waiting {
            if let Some(line) = self.pending.take() {
                self.is_prepared = true;
                return Some(line);
            }
            if let Some(line) = self.script.take() {
                self.script_goes_on = true;
                return Some(Line {
                    text: line.text,
                    origin: Origin::Script,
                    serial: 0,
                    gesture: 0,
                });
            }
            self.script_goes_on = false;
            // The next script is no deeper for this one.
            self.script = Queue::default();
        }
        let may_run = |line: &Line| match line.origin {
            Origin::Panel => true,
            Origin::Pane => !is_waiting,
            Origin::Terminal | Origin::Script => !is_waiting && !is_loading,
        };
        let at = self.lines.iter().position(may_run)?;
        self.lines.remove(at)
    }

    /// Whether there are lines to be run, now or later.
    pub(super) fn has_lines(&self) -> bool {
        self.script_goes_on || self.pending.is_some() || !self.lines.is_empty()
    }

    /// Lets the frames be rendered that a command is about to ask for; whether there are some.
    fn waits_for_frames(&mut self, line: &Line) -> bool {
        let explorer = &self.console.explorer;
        let is_prepared = std::mem::take(&mut self.is_prepared);
        let words = lines::words(&line.text).unwrap_or_default();
        let is_one = words.first().is_some_and(|name| OF_WHOLE_PICTURES.contains(&name.as_str()));
        if is_prepared || !is_one || explorer.is_single_frame || explorer.playback().is_playing {
            return false;
        }
        if explorer.scene().is_none() || self.has_failed {
            return false;
        }
        self.frames_to_wait = explorer.settings().frames;
        self.start_again();
        true
    }

    fn run_line(&mut self, line: &Line) {
        if line.text.trim().is_empty() {
            return;
        }
        self.log.add_command(line);
        let camera = self.console.explorer.camera().clone();
        if line.gesture == 0 || line.gesture != self.gesture {
            self.console.explorer.end_gesture();
        }
        self.gesture = line.gesture;
        self.begin(format!("doing `{}`", shortened(&line.text)));
        let reply = match self.run_own(&line.text) {
            Some(done) => done.map(Reply::say),
            None => pollster::block_on(self.console.run_on(&line.text)),
        };
        match reply {
            Ok(reply) => {
                self.log.add(LogKind::Reply, &reply.text);
                self.follow(reply.effect, line.origin);
            }
            Err(error) => {
                self.fail(&error);
                if line.origin == Origin::Script {
                    self.abandon();
                }
            }
        }
        // The window knows of its own.
        if line.origin != Origin::Panel && *self.console.explorer.camera() != camera {
            self.camera_moves += 1;
        }
        self.full_size = self.console.explorer.size();
        self.note_edits(&line.text);
        self.start_again();
    }

    /// Something begins that may take long.
    pub(super) fn begin(&self, words: String) {
        begin(&self.shared, &self.wake, words);
    }

    /// Nothing is under way any more.
    pub(super) fn rest(&self) {
        let mut was_busy = false;
        self.shared.change(|published| was_busy = published.doing.take().is_some());
        if was_busy {
            (self.wake)();
        }
    }

    fn follow(&mut self, effect: Effect, origin: Origin) {
        match effect {
            Effect::Nothing => {}
            Effect::Open(opening) => {
                // What a script would have done to the scene that nobody waits for any more.
                if self.loading.is_some() && origin != Origin::Script {
                    self.abandon();
                }
                self.open(*opening, false);
            }
            Effect::Wait(frames) => self.frames_to_wait = frames,
            Effect::Run(lines) => match self.script.interpose(lines) {
                Ok(()) => self.script_goes_on = true,
                Err(error) => self.fail(&error.into()),
            },
            Effect::Quit => self.is_over = true,
        }
    }

    /// Forgets the rest of a script, and what is waited for.
    pub(super) fn abandon(&mut self) {
        self.script = Queue::default();
        self.script_goes_on = false;
        self.pending = None;
        self.frames_to_wait = 0;
    }

    /// Tells of an error in the console and in the status bar.
    pub(super) fn fail(&mut self, error: &anyhow::Error) {
        let mut text = String::new();
        for cause in error.chain().map(ToString::to_string) {
            if text.is_empty() {
                text = cause;
            } else if !text.contains(&cause) {
                text += ": ";
                text += &cause;
            }
        }
        self.log.add(LogKind::Error, &text);
        let number = self.error.as_ref().map_or(0, |(number, _)| *number) + 1;
        self.error = Some((number, text));
    }

    /// Stops what somebody does not want any more; without a name, all of it.
    pub(super) fn cancel(&mut self, which: Option<Job>) {
        self.shared.go_on();
        let is_meant = |job: Job| which.is_none_or(|which| which == job);
        if is_meant(Job::Loading)
            && let Some(loading) = self.loading.take()
        {
            self.abandon();
            self.log.add(LogKind::Note, &format!("no longer waiting for {}", loading.title));
        }
        if is_meant(Job::Lines) && (self.frames_to_wait > 0 || self.script_goes_on) {
            self.abandon();
            self.log.add(LogKind::Note, "no longer waiting for frames");
        }
        if is_meant(Job::Reference) && self.tracing.as_ref().is_some_and(|tracing| !tracing.is_over)
        {
            self.compare(crate::window::model::Comparand::Nothing);
            self.log.add(LogKind::Note, "the reference is stopped");
        }
        if self.loading.is_none() && std::mem::take(&mut self.has_changed) {
            self.reload();
        }
    }

    /// Hears how far long commands are, tells it to the window, and breaks them off when somebody wants that.
    pub(super) fn hear(&self) -> Box<dyn Hear> {
        let (shared, wake) = (self.shared.clone(), self.wake.clone());
        let mut told = Instant::now();
        Box::new(move |step: Progress| {
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
                shared.change(|published| published.under_way(job));
                wake();
            }
            if shared.is_stopped() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
        })
    }
}
