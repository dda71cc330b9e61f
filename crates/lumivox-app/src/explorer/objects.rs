//! The objects of a scene: its instances, each with a name of its own.

use std::collections::HashMap;

use glam::{EulerRot, Mat4, Quat, Vec3};
use lumivox_scene::{Bounds, Instance, Scene};

use super::Explorer;
use super::opened::Opened;

/// What was changed of an object.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Edit {
    /// Applied before the place that the file or the animation gives it.
    local: Mat4,
    is_hidden: Option<bool>,
    is_static: Option<bool>,
}

impl Default for Edit {
    fn default() -> Self {
        Self { local: Mat4::IDENTITY, is_hidden: None, is_static: None }
    }
}

/// Where an object stands in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// Of its origin, m.
    pub position: Vec3,
    /// Turns about x, y and z in degrees: about z first, in the world's axes.
    pub rotation_deg: Vec3,
    /// Along its own axes.
    pub scale: Vec3,
}

impl Placement {
    /// The placement of a matrix; what shears is lost.
    pub fn of(world_from_local: Mat4) -> Self {
        let (scale, rotation, position) = world_from_local.to_scale_rotation_translation();
        let (x, y, z) = rotation.to_euler(EulerRot::XYZ);
        Self { position, rotation_deg: Vec3::new(x, y, z).map(f32::to_degrees), scale }
    }

    /// The matrix: scale, then rotation, then translation.
    pub fn matrix(&self) -> Mat4 {
        let [x, y, z] = self.rotation_deg.map(f32::to_radians).to_array();
        let rotation = Quat::from_euler(EulerRot::XYZ, x, y, z);
        Mat4::from_scale_rotation_translation(self.scale, rotation, self.position)
    }
}

/// There is no object of a name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("there is no object \"{name}\"{remedy}")]
pub struct NotFound {
    /// What was asked for.
    pub name: String,
    /// Those that there are.
    pub known: Vec<String>,
    remedy: String,
}

/// The objects' names in the order of the instances, each once: what is there already is numbered.
pub(super) fn names(scene: &Scene) -> Vec<String> {
    let mut counts = HashMap::<String, usize>::new();
    let name = |(index, instance): (usize, &Instance)| {
        let name = match instance.name.as_str() {
            "" => format!("object {}", index + 1),
            name => name.to_owned(),
        };
        let count = counts.entry(name.clone()).or_default();
        *count += 1;
        if *count == 1 { name } else { format!("{name} ({count})") }
    };
    scene.instances.iter().enumerate().map(name).collect()
}

impl Opened {
    /// Brings the instances up to date with the edits.
    pub(super) fn apply_edits(&mut self) {
        let names = names(&self.scene);
        for ((instance, posed), name) in
            self.scene.instances.iter_mut().zip(&self.posed).zip(&names)
        {
            let edit = self.edits.get(name).cloned().unwrap_or_default();
            instance.world_from_local = *posed * edit.local;
            if let Some(is_hidden) = edit.is_hidden {
                instance.is_hidden = is_hidden;
            }
            if let Some(is_static) = edit.is_static {
                instance.is_static = is_static;
            }
        }
    }
}

impl Explorer {
    /// The objects' names, in the order of the scene's instances.
    pub fn object_names(&self) -> Vec<String> {
        self.scene().map(names).unwrap_or_default()
    }

    /// The number of the object of a name, as [`Self::object_names`] has it, in the scene's instances.
    ///
    /// # Errors
    /// [`NotFound`], with names like it.
    pub fn object(&self, name: &str) -> Result<usize, NotFound> {
        let known = self.object_names();
        known.iter().position(|other| other == name).ok_or_else(|| {
            let like = crate::console::suggest::like(name, known.iter().map(String::as_str));
            let remedy = match (&like, known.is_empty()) {
                (_, true) => ": the scene is empty".to_owned(),
                (Some(like), _) => format!("; did you mean \"{like}\"?"),
                (None, _) => "; `objects` lists them".to_owned(),
            };
            NotFound { name: name.to_owned(), known, remedy }
        })
    }

    /// Where an object stands; `None` beyond the last.
    pub fn placement(&self, object: usize) -> Option<Placement> {
        let instance = self.scene()?.instances.get(object)?;
        Some(Placement::of(instance.world_from_local))
    }

    /// The box around an object in the world.
    pub fn object_bounds(&self, object: usize) -> Option<Bounds> {
        let scene = self.scene()?;
        let instance = scene.instances.get(object)?;
        let mesh = scene.meshes.get(instance.mesh)?;
        let in_world = |p: &Vec3| instance.world_from_local.transform_point3(*p);
        Some(Bounds::from_points(mesh.positions.iter().map(in_world)))
    }

    /// Puts an object elsewhere in the world.
    pub fn place(&mut self, object: usize, placement: Placement) {
        let Some(opened) = &self.opened else { return };
        if let Some(posed) = opened.posed.get(object) {
            let local = posed.inverse() * placement.matrix();
            self.edit(object, |edit| edit.local = local);
        }
    }

    /// Moves an object within its own axes: `local` comes before all that it has been through.
    pub fn transform(&mut self, object: usize, local: Mat4) {
        self.edit(object, |edit| edit.local *= local);
    }

    /// Hides an object, or shows it.
    pub fn set_hidden(&mut self, object: usize, is_hidden: bool) {
        self.edit(object, |edit| edit.is_hidden = Some(is_hidden));
    }

    /// Says that an object stays as it is while others move, or not.
    pub fn set_static(&mut self, object: usize, is_static: bool) {
        self.edit(object, |edit| edit.is_static = Some(is_static));
    }

    fn edit(&mut self, object: usize, change: impl FnOnce(&mut Edit)) {
        let Some(opened) = &mut self.opened else { return };
        if let Some(name) = names(&opened.scene).into_iter().nth(object) {
            change(opened.edits.entry(name).or_default());
            opened.apply_edits();
            self.pending.objects = true;
        }
    }
}
