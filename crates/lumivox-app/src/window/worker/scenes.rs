//! Scenes that come and go, devices that are lost, and what is under way.

use lumivox_render::Gpu;

use super::Worker;
use crate::window::jobs::Loaded;
use crate::window::model::{Comparand, Job, JobModel, LogKind};

/// Devices that may be lost one after the other without a frame between them. A workload that kills each is not tried
/// again before something changes.
const MOST_LOSSES: u32 = 3;

impl Worker {
    /// A scene is there, or an error; unless nobody waits for it any more.
    pub(super) fn take_scene(&mut self, loaded: Loaded) {
        let Some(loading) = self.jobs.take_loading(Some(loaded.number)) else { return };
        let opened = match loaded.result {
            Ok(opened) => opened,
            Err(error) => {
                self.messages.fail(&error);
                if loading.is_reload {
                    let text = "the scene stays as it was before its file changed";
                    self.messages.log.add(LogKind::Note, text);
                } else {
                    self.lines.abandon();
                }
                if self.jobs.take_change() {
                    self.reload();
                }
                return;
            }
        };
        if loading.is_reload {
            let kept = self.console.reopen(opened);
            let kept = match kept {
                0 => String::new(),
                1 => "; the changes of 1 object stay".to_owned(),
                more => format!("; the changes of {more} objects stay"),
            };
            let dropped = if self.session.has_edits {
                "; changes of materials, lights and surroundings are dropped"
            } else {
                ""
            };
            let text = format!("read {} again{kept}{dropped}", loading.title);
            self.messages.log.add(LogKind::Note, &text);
        } else {
            self.console.open(opened);
            self.session.opened += 1;
            self.console.explorer.pacing.scene_opened();
            self.session.selection.choose(None, None);
            self.messages.log.add(LogKind::Note, &format!("opened {}", loading.title));
        }
        let warnings = self.console.explorer.scene().map(|scene| scene.notes.warnings.clone());
        for warning in warnings.unwrap_or_default() {
            self.messages.log.add(LogKind::Note, &format!("warning: {warning}"));
        }
        self.forget_reference();
        self.session.has_edits = false;
        self.pictures.times.totals.clear();
        if let Err(text) = self.jobs.watch(&self.console) {
            self.messages.log.add(LogKind::Note, &text);
        }
        // No sooner: what has changed in between is heard of twice rather than never.
        drop(loading);
        self.session.view.open(&self.console);
        self.start_again();
        if self.jobs.take_change() {
            self.reload();
        }
    }

    /// Reads the scene again; where another is being read, that one once it is there.
    pub(super) fn reload(&mut self) {
        if self.jobs.is_opening() {
            self.jobs.note_change();
        } else if let Some(opening) = self.console.scene_request().cloned() {
            self.jobs.load(opening, true);
        }
    }

    /// Compares the picture with something else.
    pub(super) fn compare(&mut self, comparand: Comparand) {
        if comparand != self.pictures.comparand {
            self.pictures.comparand = comparand;
            self.forget_reference();
        }
    }

    /// Stops what is traced, and shows nothing of it any more.
    pub(super) fn forget_reference(&mut self) {
        self.jobs.forget_reference();
        self.publisher.change(|published| published.other = None);
    }

    /// Whether a failure of rendering is a loss of the device.
    pub(super) fn has_lost_device(&self) -> bool {
        let gpu = self.console.explorer.gpu();
        // A loss is told once the queue is empty, and the window may draw.
        let _ = gpu.wait("finding out whether the device is lost");
        gpu.is_lost()
    }

    /// After a failure of rendering: another device where this one is lost; whether there is something to do.
    pub(super) fn mend(&mut self, error: &anyhow::Error) -> bool {
        if !self.has_lost_device() {
            self.messages.fail(error);
            return self.give_up();
        }
        self.pictures.losses += 1;
        self.forget_reference();
        match pollster::block_on(Gpu::new(&self.options)) {
            Ok(gpu) => {
                self.publisher.change(|published| published.gpu = Some(gpu.clone()));
                self.console.explorer.set_gpu(gpu);
                if self.pictures.losses >= MOST_LOSSES {
                    self.messages.fail(&anyhow::anyhow!(
                        "the GPU was lost {} times without a frame; change the settings or the scene to try again",
                        self.pictures.losses
                    ));
                    return self.give_up();
                }
                self.messages
                    .log
                    .add(LogKind::Note, "the GPU was lost; going on with a new device");
                self.start_again();
                self.publish();
                true
            }
            Err(error) => {
                self.messages.fail(&error.into());
                self.give_up()
            }
        }
    }

    /// Tries nothing more until something changes; whether there are lines, which wait for no frames any more.
    fn give_up(&mut self) -> bool {
        self.pictures.has_failed = true;
        self.lines.frames_are_over();
        self.publish();
        self.has_work()
    }

    /// What is under way, for the window.
    pub(super) fn job_models(&self) -> Vec<JobModel> {
        let frames = self.lines.frames_to_wait();
        let waiting = (frames > 1).then(|| JobModel {
            words: format!("waiting for {frames} frames"),
            since: None,
            share: None,
            cancel: Some(Job::Lines),
        });
        let (loading, tracing) = (self.jobs.loading_model(), self.jobs.tracing_model());
        loading.into_iter().chain(waiting).chain(tracing).collect()
    }
}
