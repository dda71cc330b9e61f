//! Scenes that come and go, devices that are lost, and what is under way.

use lumivox_console::{Opening, SceneSource};
use lumivox_render::Gpu;

use super::Worker;
use crate::window::jobs::{self, Loaded};
use crate::window::model::{Comparand, Job, JobModel, LogKind, mesh_bounds};
use crate::window::reload;

/// Devices that may be lost one after the other without a frame between them. A workload that kills each is not tried
/// again before something changes.
const MOST_LOSSES: u32 = 3;

impl Worker {
    pub(super) fn open(&mut self, opening: Opening, is_reload: bool) {
        self.jobs += 1;
        // What changes while it is read is heard of.
        let watched = match &opening.source {
            SceneSource::File(file) => {
                reload::watch(file, opening.load.allow_outside, self.sender.clone()).ok()
            }
            SceneSource::Builtin(_) => None,
        };
        let mut loading = jobs::load(self.jobs, opening, is_reload, self.sender.clone());
        loading.watched = watched;
        self.loading = Some(loading);
    }

    /// A scene is there, or an error; unless nobody waits for it any more.
    pub(super) fn take_scene(&mut self, loaded: Loaded) {
        let Some(loading) = self.loading.take_if(|loading| loading.number == loaded.number) else {
            return;
        };
        let opened = match loaded.result {
            Ok(opened) => opened,
            Err(error) => {
                self.fail(&error);
                if loading.is_reload {
                    self.log
                        .add(LogKind::Note, "the scene stays as it was before its file changed");
                } else {
                    self.abandon();
                }
                if std::mem::take(&mut self.has_changed) {
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
            let dropped = if self.has_edits {
                "; changes of materials, lights and surroundings are dropped"
            } else {
                ""
            };
            self.log.add(LogKind::Note, &format!("read {} again{kept}{dropped}", loading.title));
        } else {
            self.console.open(opened);
            self.opened += 1;
            self.pace.begin_scene();
            self.selected = None;
            self.selections += 1;
            self.picked_at = None;
            self.log.add(LogKind::Note, &format!("opened {}", loading.title));
        }
        let warnings = self.console.explorer.scene().map(|scene| scene.notes.warnings.clone());
        for warning in warnings.unwrap_or_default() {
            self.log.add(LogKind::Note, &format!("warning: {warning}"));
        }
        self.forget_reference();
        self.has_edits = false;
        self.voxels_s = 0.0;
        self.stage_totals.clear();
        self.mesh_bounds = mesh_bounds(&self.console.explorer);
        self.watch();
        // No sooner: what has changed in between is heard of twice rather than never.
        drop(loading);
        self.forget_scene();
        self.names_are_old = true;
        self.start_again();
        if std::mem::take(&mut self.has_changed) {
            self.reload();
        }
    }

    /// Hears of changes of the scene's files from now on.
    fn watch(&mut self) {
        let before = self.watched.take();
        let opening = self.console.opening();
        let opening = opening.map(|opening| (opening.source.clone(), opening.load.allow_outside));
        let Some((SceneSource::File(file), allow_outside)) = opening else { return };
        match reload::watch(&file, allow_outside, self.sender.clone()) {
            Ok(watched) => {
                self.watched = Some(watched);
                drop(before);
            }
            Err(error) => {
                let text = format!("changes of {} are not noticed: {error}", file.display());
                self.log.add(LogKind::Note, &text);
            }
        }
    }

    /// Reads the scene again; where another is being read, that one once it is there.
    pub(super) fn reload(&mut self) {
        let is_loading = self.loading.as_ref().is_some_and(|loading| !loading.is_reload);
        if is_loading {
            self.has_changed = true;
        } else if let Some(opening) = self.console.opening().cloned() {
            self.open(opening, true);
        }
    }

    /// Compares the picture with something else.
    pub(super) fn compare(&mut self, comparand: Comparand) {
        if comparand != self.comparand {
            self.comparand = comparand;
            self.forget_reference();
        }
    }

    /// Stops what is traced, and shows nothing of it any more.
    pub(super) fn forget_reference(&mut self) {
        self.tracing = None;
        self.reference = None;
        self.shared.change(|published| published.other = None);
    }

    /// What is remembered of the scene's state is no longer true.
    pub(super) fn forget_scene(&mut self) {
        self.picker = None;
        self.scene_model = None;
    }

    /// After a failure of rendering: another device where this one is lost; whether there is something to do.
    pub(super) fn mend(&mut self, error: &anyhow::Error) -> bool {
        if !self.console.explorer.gpu().is_lost() {
            self.fail(error);
            return self.give_up();
        }
        self.losses += 1;
        self.forget_reference();
        match pollster::block_on(Gpu::new(&self.options)) {
            Ok(gpu) => {
                self.console.explorer.set_gpu(gpu);
                if self.losses >= MOST_LOSSES {
                    self.fail(&anyhow::anyhow!(
                        "the GPU was lost {} times without a frame; change the settings or the scene to try again",
                        self.losses
                    ));
                    return self.give_up();
                }
                self.log.add(LogKind::Note, "the GPU was lost; going on with a new device");
                self.start_again();
                self.publish();
                true
            }
            Err(error) => {
                self.fail(&error.into());
                self.give_up()
            }
        }
    }

    /// Tries nothing more until something changes; whether there are lines, which wait for no frames any more.
    fn give_up(&mut self) -> bool {
        self.has_failed = true;
        self.frames_to_wait = 0;
        self.publish();
        self.has_work()
    }

    /// What is under way, for the window.
    pub(super) fn jobs(&self) -> Vec<JobModel> {
        let loading = self.loading.as_ref().map(|loading| JobModel {
            words: format!("{}: {}", loading.title, loading.watch.words()),
            since: None,
            share: loading.watch.share(),
            cancel: Some(Job::Loading),
        });
        let waiting = (self.frames_to_wait > 1).then(|| JobModel {
            words: format!("waiting for {} frames", self.frames_to_wait),
            since: None,
            share: None,
            cancel: Some(Job::Lines),
        });
        let tracing = self.tracing.as_ref().filter(|tracing| !tracing.is_over);
        let tracing = tracing.map(|tracing| JobModel {
            words: format!(
                "reference: sample {:.0} of {}",
                tracing.samples().floor(),
                tracing.total()
            ),
            since: Some(tracing.since),
            share: Some(tracing.samples() / tracing.total() as f32),
            cancel: Some(Job::Reference),
        });
        loading.into_iter().chain(waiting).chain(tracing).collect()
    }
}
