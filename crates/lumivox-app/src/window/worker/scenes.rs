//! Applying scenes, replacing lost devices, and the jobs in progress.

use lumivox_render::Gpu;

use super::Worker;
use crate::window::jobs::Loaded;
use crate::window::model::{Comparand, Job, JobModel, LogKind};

/// Number of lost devices without a frame in between after which rendering pauses until something
/// changes: the workload may kill every device.
const MOST_LOSSES: u32 = 3;

impl Worker {
    /// Applies the result of reading a scene, unless it was cancelled.
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
        // Drop the old watcher only now: a change in between is then reported twice rather than
        // never.
        drop(loading);
        self.session.view.open(&self.console);
        self.start_again();
        if self.jobs.take_change() {
            self.reload();
        }
    }

    /// Reloads the scene; if another is being opened, reloads that afterwards.
    pub(super) fn reload(&mut self) {
        if self.jobs.is_opening() {
            self.jobs.note_change();
        } else if let Some(opening) = self.console.scene_request().cloned() {
            self.jobs.load(opening, true);
        }
    }

    /// Sets what the picture is compared with.
    pub(super) fn compare(&mut self, comparand: Comparand) {
        if comparand != self.pictures.comparand {
            self.pictures.comparand = comparand;
            self.forget_reference();
        }
    }

    /// Stops tracing, and drops the reference or other view.
    pub(super) fn forget_reference(&mut self) {
        self.jobs.forget_reference();
        self.publisher.change(|published| published.other = None);
    }

    /// Whether rendering failed because the device was lost.
    pub(super) fn has_lost_device(&self) -> bool {
        let gpu = self.console.explorer.gpu();
        // wgpu reports a loss once the queue is empty, and the window may be drawing.
        let _ = gpu.wait("finding out whether the device is lost");
        gpu.is_lost()
    }

    /// Handles a failure of rendering; opens another device if this one is lost. Returns whether
    /// there is work to do.
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

    /// Stops rendering until something changes. Lines no longer wait for frames; returns whether
    /// any can run.
    fn give_up(&mut self) -> bool {
        self.pictures.has_failed = true;
        self.lines.frames_are_over();
        self.publish();
        self.has_work()
    }

    /// The jobs in progress, for the panels.
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
