//! State of the scene that is shown: the selection, and the model that the panels show.

use std::sync::Arc;

use glam::Vec3;
use lumivox_console::{Console, Names};
use lumivox_scene::{Bounds, Picker, Scene};

use crate::window::model::{SceneModel, Selected, mesh_bounds, scene_model};

/// The scene that is shown, as the window knows it.
#[derive(Default)]
pub struct Session {
    /// Scenes that were opened.
    pub opened: u64,
    /// Lines that have moved the camera.
    pub camera_moves: u64,
    /// Materials, lights or surroundings were changed since the scene was read.
    pub has_edits: bool,
    pub selection: Selection,
    pub view: SceneView,
}

/// The selected object or light.
#[derive(Default)]
pub struct Selection {
    pub selected: Option<Selected>,
    /// Counts selections.
    pub changes: u64,
    /// The point that was clicked: the camera turns about it.
    pub picked_at: Option<Vec3>,
}

impl Selection {
    /// Chooses something, by a click at a point or otherwise.
    pub fn choose(&mut self, selected: Option<Selected>, picked_at: Option<Vec3>) {
        self.selected = selected;
        self.picked_at = picked_at;
        self.changes += 1;
    }

    /// Objects and lights may be gone.
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

/// A cache of what is computed from the scene, until it changes.
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
    /// Another scene is shown.
    pub fn open(&mut self, console: &Console) {
        self.mesh_bounds = mesh_bounds(&console.explorer);
        self.forget();
        self.names_are_old = true;
    }

    /// Objects, materials or lights have changed, maybe also their names.
    pub fn change(&mut self) {
        self.forget();
        self.names_are_old = true;
    }

    /// Drops what is computed from the scene's state.
    pub fn forget(&mut self) {
        self.picker = None;
        self.model = None;
    }

    /// The scene as the panels see it.
    pub fn model(&mut self, console: &Console) -> Option<Arc<SceneModel>> {
        if self.model.is_none() {
            self.model = scene_model(console, &self.mesh_bounds).map(Arc::new);
        }
        self.model.clone()
    }

    /// Finds what is along a ray.
    pub fn picker(&mut self, scene: &Scene) -> &Picker {
        self.picker.get_or_insert_with(|| Picker::new(scene))
    }

    /// Looks up names again if they may have changed, and returns them then.
    pub fn renew_names(&mut self, console: &Console) -> Option<&Names> {
        if !std::mem::take(&mut self.names_are_old) {
            return None;
        }
        self.names = console.names();
        Some(&self.names)
    }

    /// Names that can be completed.
    pub fn names(&self) -> &Names {
        &self.names
    }
}
