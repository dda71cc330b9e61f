//! State of the open scene: the selection, and the scene's model for the panels.

use std::sync::Arc;

use glam::Vec3;
use lumivox_console::{Console, Names};
use lumivox_scene::{Bounds, Picker, Scene};

use crate::window::model::{SceneModel, Selected, mesh_bounds, scene_model};

/// State of the open scene.
#[derive(Default)]
pub struct Session {
    /// Number of scenes opened so far.
    pub opened: u64,
    /// Number of the last camera from the window that was set.
    pub cameras_done: u64,
    /// `true` if materials, lights or surroundings were changed since the scene was read.
    pub has_edits: bool,
    pub selection: Selection,
    pub view: SceneView,
}

/// The selected object or light.
#[derive(Default)]
pub struct Selection {
    pub selected: Option<Selected>,
    /// Number of changes of the selection.
    pub changes: u64,
    /// The clicked point, which the camera orbits.
    pub picked_at: Option<Vec3>,
}

impl Selection {
    /// Sets the selection, and the clicked point, if any.
    pub fn choose(&mut self, selected: Option<Selected>, picked_at: Option<Vec3>) {
        self.selected = selected;
        self.picked_at = picked_at;
        self.changes += 1;
    }

    /// Clears the selection if its object or light no longer exists.
    pub fn check(&mut self, scene: Option<&SceneModel>) {
        let is_there = |selected: &Selected| {
            scene.is_some_and(|scene| match selected {
                Selected::Object(name) => scene.objects.iter().any(|object| object.name == *name),
                Selected::Light(name) => scene.lights.iter().any(|(light, _)| light == name),
            })
        };
        if self.selected.as_ref().is_some_and(|selected| !is_there(selected)) {
            self.selected = None;
            self.changes += 1;
        }
    }
}

/// A cache of data that is computed from the scene.
pub struct SceneView {
    mesh_bounds: Vec<Bounds>,
    model: Option<Arc<SceneModel>>,
    picker: Option<Picker>,
    names: Names,
    names_are_old: bool,
}

impl Default for SceneView {
    fn default() -> Self {
        let (model, picker, names) = (None, None, Names::default());
        Self { mesh_bounds: Vec::new(), model, picker, names, names_are_old: true }
    }
}

impl SceneView {
    /// Resets the cache for another scene.
    pub fn open(&mut self, console: &Console) {
        self.mesh_bounds = mesh_bounds(&console.explorer);
        self.forget();
        self.names_are_old = true;
    }

    /// Invalidates the cache and the names, after a change of objects, materials or lights.
    pub fn change(&mut self) {
        self.forget();
        self.names_are_old = true;
    }

    /// Invalidates the cache, except the names.
    pub fn forget(&mut self) {
        self.picker = None;
        self.model = None;
    }

    /// The panels' model of the scene.
    pub fn model(&mut self, console: &Console) -> Option<Arc<SceneModel>> {
        if self.model.is_none() {
            self.model = scene_model(console, &self.mesh_bounds).map(Arc::new);
        }
        self.model.clone()
    }

    /// The picker, which finds the object along a ray.
    pub fn picker(&mut self, scene: &Scene) -> &Picker {
        self.picker.get_or_insert_with(|| Picker::new(scene))
    }

    /// Updates and returns the names for completion if they may have changed.
    pub fn renew_names(&mut self, console: &Console) -> Option<&Names> {
        if !std::mem::take(&mut self.names_are_old) {
            return None;
        }
        self.names = console.names();
        Some(&self.names)
    }

    /// The names for completion.
    pub fn names(&self) -> &Names {
        &self.names
    }
}
