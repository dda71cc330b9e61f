//! The objects of a scene: its instances, each with a name of its own.

use glam::{EulerRot, Mat4, Quat, Vec3, Vec4};

use super::Explorer;
use super::names::{NotFound, names_of_objects as names};
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
        NotFound::or_place("object", name, self.object_names())
    }

    /// Where an object stands; `None` beyond the last.
    pub fn placement(&self, object: usize) -> Option<Placement> {
        let instance = self.scene()?.instances.get(object)?;
        Some(Placement::of(instance.world_from_local))
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

    /// The part of an object's transform that was added to the place which its file or its animation gives it, and
    /// what it comes before.
    pub fn local_edit(&self, object: usize) -> Option<Mat4> {
        let opened = self.opened.as_ref()?;
        let name = names(&opened.scene).into_iter().nth(object)?;
        Some(opened.edits.get(&name).map_or(Mat4::IDENTITY, |edit| edit.local))
    }

    /// Sets it.
    pub fn set_local_edit(&mut self, object: usize, local: Mat4) {
        self.edit(object, |edit| edit.local = local);
    }

    /// Whether an object was hidden or shown, and made static or not, against what its file says.
    pub fn marks(&self, object: usize) -> (Option<bool>, Option<bool>) {
        let edit = self
            .opened
            .as_ref()
            .and_then(|opened| opened.edits.get(&names(&opened.scene).into_iter().nth(object)?));
        edit.map_or((None, None), |edit| (edit.is_hidden, edit.is_static))
    }

    fn edit(&mut self, object: usize, change: impl FnOnce(&mut Edit)) {
        let Some(opened) = &mut self.opened else { return };
        if let Some(name) = names(&opened.scene).into_iter().nth(object) {
            let edit = opened.edits.entry(name).or_default();
            change(edit);
            // What rounding left of a projection would shear what it is multiplied with.
            let last_row = Vec4::W;
            edit.local = edit.local.transpose();
            edit.local.w_axis = last_row;
            edit.local = edit.local.transpose();
            opened.apply_edits();
            self.pending.objects = true;
        }
    }
}
