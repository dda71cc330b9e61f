//! Reading scenes beside the picture, and reading them again when their files change.

use super::Worker;
use crate::args::scene::SceneSource;
use crate::explorer::Opening;
use crate::window::jobs::{self, Loaded};
use crate::window::model::{Comparand, LogKind};
use crate::window::reload;

impl Worker {
    pub(super) fn open(&mut self, opening: Opening, is_reload: bool) {
        self.jobs += 1;
        self.loading = Some(jobs::load(self.jobs, opening, is_reload, self.sender.clone()));
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
                }
                return;
            }
        };
        if loading.is_reload {
            let kept = self.console.explorer.reopen(opened);
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
            self.console.explorer.open(opened);
            self.selected = None;
            self.selections += 1;
            self.picked_at = None;
            self.log.add(LogKind::Note, &format!("opened {}", loading.title));
        }
        let warnings = self.console.explorer.scene().map(|scene| scene.notes.warnings.clone());
        for warning in warnings.unwrap_or_default() {
            self.log.add(LogKind::Note, &format!("warning: {warning}"));
        }
        self.tracing = None;
        self.has_edits = false;
        self.mesh_bounds = crate::window::model::mesh_bounds(&self.console.explorer);
        self.watch();
        self.forget_scene();
        self.start_again();
    }

    /// Hears of changes of the scene's files from now on.
    pub(super) fn watch(&mut self) {
        self.watched = None;
        let source = self.console.explorer.opening().map(|opening| opening.source.clone());
        let Some(SceneSource::File(file)) = source else { return };
        match reload::watch(&file, self.sender.clone()) {
            Ok(watched) => self.watched = Some(watched),
            Err(error) => {
                let text = format!("changes of {} are not noticed: {error}", file.display());
                self.log.add(LogKind::Note, &text);
            }
        }
    }

    pub(super) fn reload(&mut self) {
        let is_loading = self.loading.as_ref().is_some_and(|loading| !loading.is_reload);
        if let Some(opening) = self.console.explorer.opening().cloned()
            && !is_loading
        {
            self.open(opening, true);
        }
    }

    pub(super) fn cancel(&mut self) {
        if let Some(loading) = self.loading.take() {
            self.log.add(LogKind::Note, &format!("no longer waiting for {}", loading.title));
        } else if let Some(tracing) = &mut self.tracing
            && !tracing.is_over
        {
            self.comparand = Comparand::Nothing;
            self.tracing = None;
            self.log.add(LogKind::Note, "the reference is stopped");
        }
    }
}
