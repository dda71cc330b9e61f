//! Work of other threads that the worker waits for: a scene that is read, a reference that is
//! traced, files that are watched.

use std::sync::mpsc::Sender;

use glam::UVec2;
use lumivox_console::{Console, SceneRequest, SceneSource};
use lumivox_explorer::Explorer;

use crate::window::jobs::{self, Loading, Reference, ReferenceKey, Traced, Tracing};
use crate::window::model::{Job, JobModel};
use crate::window::orders::Order;
use crate::window::reload::{self, Watched};

/// Work of other threads.
pub struct Jobs {
    orders: Sender<Order>,
    loading: Option<Loading>,
    tracing: Option<Tracing>,
    /// The picture of the reference so far.
    pub reference: Option<Reference>,
    watched: Option<Watched>,
    /// Files have changed while a scene was read.
    has_changed: bool,
    count: u64,
}

impl Jobs {
    /// Nothing yet; results are sent as orders.
    pub fn new(orders: Sender<Order>) -> Self {
        let (loading, tracing, reference, watched) = (None, None, None, None);
        Self { orders, loading, tracing, reference, watched, has_changed: false, count: 0 }
    }

    /// Whether there are some, or results of some.
    pub fn are_there(&self) -> bool {
        self.loading.is_some() || self.tracing.is_some()
    }

    /// Whether there is progress to be shown.
    pub fn are_under_way(&self) -> bool {
        self.loading.is_some() || self.is_tracing()
    }

    /// Begins to read a scene, in the place of the one that is being read.
    pub fn load(&mut self, opening: SceneRequest, is_reload: bool) {
        self.count += 1;
        // Files may change while the scene is read.
        let watched = match &opening.source {
            SceneSource::File(file) => {
                reload::watch(file, opening.load.allow_outside, self.orders.clone()).ok()
            }
            SceneSource::Builtin(_) => None,
        };
        let mut loading = jobs::load(self.count, opening, is_reload, self.orders.clone());
        loading.watched = watched;
        self.loading = Some(loading);
    }

    /// Whether a scene is being read.
    pub fn is_loading(&self) -> bool {
        self.loading.is_some()
    }

    /// Whether another scene than the one that is shown is being read.
    pub fn is_opening(&self) -> bool {
        self.loading.as_ref().is_some_and(|loading| !loading.is_reload)
    }

    /// Ends the reading of this number, or whichever there is.
    pub fn take_loading(&mut self, number: Option<u64>) -> Option<Loading> {
        self.loading.take_if(|loading| number.is_none_or(|number| loading.number == number))
    }

    /// Remembers that files have changed while a scene is read.
    pub fn note_change(&mut self) {
        self.has_changed = true;
    }

    /// Whether they had; asked once.
    pub fn take_change(&mut self) -> bool {
        std::mem::take(&mut self.has_changed)
    }

    /// Watches the files of the scene that is shown.
    ///
    /// # Errors
    /// When the system does not watch files; with a sentence on it.
    pub fn watch(&mut self, console: &Console) -> Result<(), String> {
        let before = self.watched.take();
        let opening = console.scene_request();
        let opening = opening.map(|opening| (opening.source.clone(), opening.load.allow_outside));
        let Some((SceneSource::File(file), allow_outside)) = opening else { return Ok(()) };
        match reload::watch(&file, allow_outside, self.orders.clone()) {
            Ok(watched) => {
                self.watched = Some(watched);
                drop(before);
                Ok(())
            }
            Err(error) => Err(format!("changes of {} are not noticed: {error}", file.display())),
        }
    }

    /// Whether a reference gets more samples.
    pub fn is_tracing(&self) -> bool {
        self.tracing.as_ref().is_some_and(|tracing| !tracing.is_over)
    }

    /// Traces a reference of what the explorer shows, unless it is there already; whether another
    /// one has begun.
    pub fn trace(&mut self, explorer: &Explorer, samples: u32) -> bool {
        let Some(scene) = explorer.scene() else { return false };
        let key = ReferenceKey::new(scene, explorer.camera(), explorer.settings(), samples);
        if self.tracing.as_ref().is_some_and(|tracing| tracing.key == key) {
            return false;
        }
        // The old one goes first: its memory and its time are for the new one.
        self.forget_reference();
        self.count += 1;
        let (gpu, scene, orders) = (explorer.gpu().clone(), scene.clone(), self.orders.clone());
        self.tracing = Some(jobs::trace(self.count, gpu, scene, key, orders));
        true
    }

    /// Whether a reference is of another state than the explorer's, in pictures of this size.
    pub fn is_reference_old(&self, explorer: &Explorer, size: UVec2) -> bool {
        let is_of = |tracing: &Tracing| {
            let is_of = |scene| tracing.key.is_of(scene, explorer.camera(), size);
            explorer.scene().is_some_and(is_of)
        };
        self.tracing.as_ref().is_some_and(|tracing| !is_of(tracing))
    }

    /// Takes news of the reference that is traced; `None` where they are of another one.
    pub fn take_traced(&mut self, traced: Traced) -> Option<anyhow::Result<()>> {
        let tracing = self.tracing.as_mut().filter(|tracing| tracing.number == traced.number)?;
        tracing.is_over = traced.is_last;
        Some(traced.result.map(|reference| self.reference = Some(reference)))
    }

    /// Stops what is traced.
    pub fn forget_reference(&mut self) {
        self.tracing = None;
        self.reference = None;
    }

    /// The scene that is read, for the window.
    pub fn loading_model(&self) -> Option<JobModel> {
        self.loading.as_ref().map(|loading| JobModel {
            words: format!("{}: {}", loading.title, loading.watch.words()),
            since: None,
            share: loading.watch.share(),
            cancel: Some(Job::Loading),
        })
    }

    /// The reference that is traced, for the window.
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
