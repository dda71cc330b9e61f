//! Jobs on other threads: reading a scene, tracing a reference, watching files.

use std::path::Path;
use std::sync::mpsc::Sender;

use glam::UVec2;
use lumivox_console::{Console, SceneRequest, SceneSource};
use lumivox_explorer::Explorer;

use crate::window::jobs::{self, Loading, Reference, ReferenceKey, Traced, Tracing};
use crate::window::model::{Job, JobModel};
use crate::window::orders::Order;
use crate::window::reload::{self, Watched};

/// Jobs on other threads.
pub struct Jobs {
    orders: Sender<Order>,
    loading: Option<Loading>,
    tracing: Option<Tracing>,
    /// The reference as traced so far.
    pub reference: Option<Reference>,
    watched: Option<Watched>,
    /// `true` if files have changed while a scene was being read.
    has_changed: bool,
    count: u64,
}

impl Jobs {
    /// No jobs; results will be sent to `orders`.
    pub fn new(orders: Sender<Order>) -> Self {
        let (loading, tracing, reference, watched) = (None, None, None, None);
        Self { orders, loading, tracing, reference, watched, has_changed: false, count: 0 }
    }

    /// Whether a scene is being read, or a complete or partial reference exists.
    pub fn are_there(&self) -> bool {
        self.loading.is_some() || self.tracing.is_some()
    }

    /// Whether a job is in progress.
    pub fn are_under_way(&self) -> bool {
        self.loading.is_some() || self.is_tracing()
    }

    /// Starts reading a scene, in place of one that is being read.
    pub fn load(&mut self, opening: SceneRequest, is_reload: bool) {
        self.count += 1;
        // Files may change while the scene is read.
        let watched = match &opening.source {
            SceneSource::File(file) => self.watched(file, opening.load.allow_outside).ok(),
            SceneSource::Builtin(_) => None,
        };
        let orders = self.orders.clone();
        // The receiver is gone if the window was closed.
        let done = move |loaded| drop(orders.send(Order::Loaded(Box::new(loaded))));
        let mut loading = jobs::load(self.count, opening, is_reload, done);
        loading.watched = watched;
        self.loading = Some(loading);
    }

    /// Whether a scene is being read.
    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// Whether a scene other than the shown one is being read.
    pub fn is_opening(&self) -> bool {
        self.loading.as_ref().is_some_and(|loading| !loading.is_reload)
    }

    /// Takes the load of this number; any load if `number` is `None`.
    pub fn take_loading(&mut self, number: Option<u64>) -> Option<Loading> {
        self.loading.take_if(|loading| number.is_none_or(|number| loading.number == number))
    }

    /// Notes that files have changed while a scene is being read.
    pub fn note_change(&mut self) {
        self.has_changed = true;
    }

    /// Whether a change was noted; clears the note.
    pub fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    /// Watches the files of the scene that is shown.
    ///
    /// # Errors
    /// A message, when the system cannot watch the files.
    pub fn watch(&mut self, console: &Console) -> Result<(), String> {
        let before = self.watched.take();
        let opening = console.scene_request();
        let opening = opening.map(|opening| (opening.source.clone(), opening.load.allow_outside));
        let Some((SceneSource::File(file), allow_outside)) = opening else { return Ok(()) };
        match self.watched(&file, allow_outside) {
            Ok(watched) => {
                self.watched = Some(watched);
                drop(before);
                Ok(())
            }
            Err(error) => Err(format!("changes of {} are not noticed: {error}", file.display())),
        }
    }

    /// A watcher of a scene's files, which sends their changes as orders.
    fn watched(&self, file: &Path, allow_outside: bool) -> notify::Result<Watched> {
        let orders = self.orders.clone();
        reload::watch(file, allow_outside, move || drop(orders.send(Order::FilesChanged)))
    }

    /// Whether a reference is being traced.
    pub fn is_tracing(&self) -> bool {
        self.tracing.as_ref().is_some_and(|tracing| !tracing.is_over)
    }

    /// Starts tracing a reference of the explorer's picture, unless the current one matches;
    /// returns whether it has started one.
    pub fn trace(&mut self, explorer: &Explorer, samples: u32) -> bool {
        let Some(scene) = explorer.scene() else { return false };
        let key = ReferenceKey::new(scene, explorer.camera(), explorer.settings(), samples);
        if self.tracing.as_ref().is_some_and(|tracing| tracing.key == key) {
            return false;
        }
        // Drop the old reference first, to free its memory and stop its work.
        self.forget_reference();
        self.count += 1;
        let (gpu, scene, orders) = (explorer.gpu().clone(), scene.clone(), self.orders.clone());
        let done = move |traced| drop(orders.send(Order::Traced(Box::new(traced))));
        self.tracing = Some(jobs::trace(self.count, gpu, scene, key, done));
        true
    }

    /// Whether the reference belongs to another state than the explorer's, or another size.
    pub fn is_reference_old(&self, explorer: &Explorer, size: UVec2) -> bool {
        let is_of = |tracing: &Tracing| {
            let is_of = |scene| tracing.key.is_of(scene, explorer.camera(), size);
            explorer.scene().is_some_and(is_of)
        };
        self.tracing.as_ref().is_some_and(|tracing| !is_of(tracing))
    }

    /// Applies a result of the current reference; `None` if it belongs to a different reference.
    pub fn take_traced(&mut self, traced: Traced) -> Option<anyhow::Result<()>> {
        let tracing = self.tracing.as_mut().filter(|tracing| tracing.number == traced.number)?;
        tracing.is_over = traced.is_last;
        Some(traced.result.map(|reference| self.reference = Some(reference)))
    }

    /// Stops tracing, and drops the reference.
    pub fn forget_reference(&mut self) {
        self.tracing = None;
        self.reference = None;
    }

    /// The job of reading a scene, for the panels.
    pub fn loading_model(&self) -> Option<JobModel> {
        self.loading.as_ref().map(|loading| JobModel {
            words: format!("{}: {}", loading.title, loading.watch.words()),
            since: None,
            share: loading.watch.share(),
            cancel: Some(Job::Loading),
        })
    }

    /// The job of tracing a reference, for the panels.
    pub fn tracing_model(&self) -> Option<JobModel> {
        let tracing = self.tracing.as_ref().filter(|tracing| !tracing.is_over)?;
        let (samples, total) = (tracing.samples(), tracing.total());
        Some(JobModel {
            words: format!("reference: sample {:.0} of {total}", samples.floor()),
            since: Some(tracing.since),
            share: Some(samples / total as f32),
            cancel: Some(Job::Reference),
        })
    }
}
