//! The objects of a scene: its instances, each with a name of its own.

use glam::{EulerRot, Mat4, Quat, Vec3, Vec4};

use crate::Explorer;
use crate::history::Key;
use crate::names::NotFound;
use crate::opened::PreparedScene;

/// The changes made to an object.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Edit {
    /// Transform applied before that of the file or the animation.
    local: Mat4,
    is_hidden: Option<bool>,
    is_static: Option<bool>,
}

/// The file's marks of an object.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Marks {
    is_hidden: bool,
    is_static: bool,
}

impl Marks {
    pub(crate) fn of(instance: &lumivox_scene::Instance) -> Self {
        Self { is_hidden: instance.is_hidden, is_static: instance.is_static }
    }
}

impl Default for Edit {
    fn default() -> Self {
        Self { local: Mat4::IDENTITY, is_hidden: None, is_static: None }
    }
}

/// The place of an object in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placement {
    /// The position of its origin, m.
    pub position: Vec3,
    /// Rotation about x, y and z in degrees: about z first, in the world's axes.
    pub rotation_deg: Vec3,
    /// Scale along its own axes.
    pub scale: Vec3,
}

impl Placement {
    /// The placement of a matrix, without its shear.
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

impl PreparedScene {
    /// Applies the edits to the instances.
    pub(crate) fn apply_edits(&mut self) {
        for object in 0..self.scene.instances.len() {
            self.apply_edit(object);
        }
    }

    /// Applies the edit of one object.
    pub(crate) fn apply_edit(&mut self, object: usize) {
        let (Some(instance), Some(posed), Some(marks)) =
            (self.scene.instances.get_mut(object), self.posed.get(object), self.marks.get(object))
        else {
            return;
        };
        let edit = self.names.get(object).and_then(|name| self.edits.get(name));
        let edit = edit.cloned().unwrap_or_default();
        instance.world_from_local = *posed * edit.local;
        instance.is_hidden = edit.is_hidden.unwrap_or(marks.is_hidden);
        instance.is_static = edit.is_static.unwrap_or(marks.is_static);
    }

    fn edit_of(&self, object: usize) -> Option<&Edit> {
        self.edits.get(self.names.get(object)?)
    }
}

impl Explorer {
    /// The objects' names, in the order of the scene's instances.
    pub fn object_names(&self) -> Vec<String> {
        self.known_objects().to_vec()
    }

    fn known_objects(&self) -> &[String] {
        self.opened.as_ref().map_or(&[], |opened| &opened.names)
    }

    /// The number of the object of this name: its place in [`Self::object_names`] and in the
    /// scene's instances.
    ///
    /// # Errors
    /// [`NotFound`], with names like it.
    pub fn object(&self, name: &str) -> Result<usize, NotFound> {
        NotFound::or_place("object", name, self.known_objects())
    }

    /// The placement of an object; `None` beyond the last.
    pub fn placement(&self, object: usize) -> Option<Placement> {
        let instance = self.scene()?.instances.get(object)?;
        Some(Placement::of(instance.world_from_local))
    }

    /// An object's transform from its file or animation; `None` beyond the last.
    pub fn posed(&self, object: usize) -> Option<Mat4> {
        self.opened.as_ref()?.posed.get(object).copied()
    }

    /// The edit for [`Self::set_local_edit`] that puts an object at a place in the world. It is not
    /// finite if an animation has scaled the object to nothing.
    pub fn local_edit_for(&self, object: usize, placement: Placement) -> Option<Mat4> {
        Some(self.posed(object)?.inverse() * placement.matrix())
    }

    /// Moves an object along its own axes: `local` is applied before all earlier transforms.
    pub fn transform(&mut self, object: usize, local: Mat4) {
        self.edit(object, |edit| edit.local *= local);
    }

    /// Hides an object, or shows it.
    pub fn set_hidden(&mut self, object: usize, is_hidden: bool) {
        self.edit(object, |edit| edit.is_hidden = Some(is_hidden));
    }

    /// Marks an object as static (it stays while others move) or dynamic.
    pub fn set_static(&mut self, object: usize, is_static: bool) {
        self.edit(object, |edit| edit.is_static = Some(is_static));
    }

    /// The transform that was added to an object, applied before that of its file or animation.
    pub fn local_edit(&self, object: usize) -> Option<Mat4> {
        self.posed(object)?;
        let edit = self.opened.as_ref().and_then(|opened| opened.edit_of(object));
        Some(edit.map_or(Mat4::IDENTITY, |edit| edit.local))
    }

    /// Sets the transform of [`Self::local_edit`].
    pub fn set_local_edit(&mut self, object: usize, local: Mat4) {
        self.edit(object, |edit| edit.local = local);
    }

    /// Whether a user has set the object hidden, and static; `None` if the file decides.
    pub fn marks(&self, object: usize) -> (Option<bool>, Option<bool>) {
        let edit = self.opened.as_ref().and_then(|opened| opened.edit_of(object));
        edit.map_or((None, None), |edit| (edit.is_hidden, edit.is_static))
    }

    /// Notes that an object may have moved, or was hidden or shown.
    pub(crate) fn note_moved(&mut self, object: usize) {
        if let Some(opened) = &self.opened {
            self.boxes.follow(&opened.scene, object);
            self.pending.objects.insert(object);
        }
    }

    fn edit(&mut self, object: usize, change: impl FnOnce(&mut Edit)) {
        if let Some(name) = self.known_objects().get(object) {
            self.keep(Key::Object(name.clone()));
        }
        let Some(opened) = &mut self.opened else { return };
        if let Some(name) = opened.names.get(object) {
            let edit = opened.edits.entry(name.clone()).or_default();
            change(edit);
            // Rounding in the last row would act as a projection in later products.
            let last_row = Vec4::W;
            edit.local = edit.local.transpose();
            edit.local.w_axis = last_row;
            edit.local = edit.local.transpose();
            opened.apply_edit(object);
            self.note_moved(object);
        }
    }
}
