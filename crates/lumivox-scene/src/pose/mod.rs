//! Poses: the scene at a time of an animation.
//!
//! A scene from a file with animations keeps a [`Rig`]: the tree of nodes, the channels that move
//! them, the meshes that bones and morph targets deform, and the things on each node.
//! [`Scene::pose`] always computes transforms, lights, cameras and vertices from the file's values,
//! so nothing drifts: the same time gives the same bits, whatever was shown before.
//!
//! | file | idea |
//! | --- | --- |
//! | `sampler.rs` | values between key frames |
//! | `rig.rs` | the tree of nodes at a time |
//! | `deform.rs` | vertices that follow morph targets and bones |
//! | `place.rs` | lights and cameras on nodes |
//! | `apply.rs` | all of it into the scene |
//! | `moved.rs` | the parts that differ between two poses |

mod apply;
mod deform;
mod moved;
mod place;
mod rig;
mod sampler;

use std::sync::Arc;

use glam::Mat4;

use crate::{Camera, Light, Scene, SceneError};

pub(crate) use apply::weighing;
pub(crate) use deform::{Base, Deformed, Influences, Target};
pub use moved::{Moved, Places};
pub(crate) use place::{place_camera, place_light};
pub(crate) use rig::{
    Animation, Channel, Local, Node, Parts, Placed, Pose, Property, Skin, handedness, moving,
};
pub(crate) use sampler::{Interpolation, Track};

/// An animation of a scene, for lists.
#[derive(Clone, Debug, PartialEq)]
pub struct AnimationInfo {
    /// Its name in the file, or its number.
    pub name: String,
    /// The duration from 0 to the last key, in seconds.
    pub duration_s: f32,
}

/// The animation that [`Scene::pose`] plays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AnimationChoice {
    /// The animation of this index in [`Scene::animations`].
    One(usize),
    /// All animations at once. If two move the same property, the later one in the list wins.
    All,
}

/// The data that a scene needs to be posed; see [`Scene::rig`]. Cheap to clone.
#[derive(Clone, PartialEq)]
pub struct Rig {
    parts: Arc<Parts>,
    /// The product of all calls of [`Scene::transform`] since loading.
    world_from_file: Mat4,
    /// Indices of the rig's instances that are now the scene's first instances; the others are left
    /// out.
    shown: Vec<usize>,
    /// `true` if the lights are no longer the file's; poses then do not move them.
    has_own_lights: bool,
    /// As `has_own_lights`, for cameras.
    has_own_cameras: bool,
}

impl std::fmt::Debug for Rig {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Rig")
            .field("nodes", &self.parts.nodes.len())
            .field("animations", &self.parts.animations.len())
            .field("deformed_meshes", &self.parts.deformed.len())
            .finish_non_exhaustive()
    }
}

impl Scene {
    /// Whether poses change meshes, and not only transforms.
    pub fn is_deformed(&self) -> bool {
        self.rig.as_ref().is_some_and(|rig| !rig.parts.deformed.is_empty())
    }

    /// The animations that [`Scene::pose`] can play, in the file's order; none without a rig.
    pub fn animations(&self) -> Vec<AnimationInfo> {
        let animations = self.rig.iter().flat_map(|rig| &rig.parts.animations);
        animations
            .map(|a| AnimationInfo { name: a.name.clone(), duration_s: a.duration_s })
            .collect()
    }

    /// Replaces the lights. If the file's lights still come first, matched by name, poses continue
    /// to move them; otherwise later poses do not move any lights.
    pub fn replace_lights(&mut self, lights: Vec<Light>) {
        if let Some(rig) = &mut self.rig {
            let moved = self.lights.iter().take(rig.parts.lights.len()).map(|light| &light.name);
            rig.has_own_lights |= !begins_with(lights.iter().map(|light| &light.name), moved);
        }
        self.lights = lights;
    }

    /// Replaces the cameras, as [`Self::replace_lights`] does the lights.
    pub fn replace_cameras(&mut self, cameras: Vec<Camera>) {
        if let Some(rig) = &mut self.rig {
            let moved =
                self.cameras.iter().take(rig.parts.cameras.len()).map(|camera| &camera.name);
            rig.has_own_cameras |= !begins_with(cameras.iter().map(|camera| &camera.name), moved);
        }
        self.cameras = cameras;
    }

    /// Shows the scene `time_s` seconds into an animation. Times before 0 show its start, times
    /// beyond its duration its end; it does not repeat.
    ///
    /// Changes transforms and meshes of instances, positions and directions of lights and cameras,
    /// and positions, normals, tangents and triangles of meshes that bones or morph targets deform.
    /// Everything that the animation does not move is as in the file. While an instance's transform
    /// scales two axes to zero, or its triangles have no area, the instance is left out of
    /// [`Scene::instances`]. Meshes keep their indices; a mesh without visible triangles stays in
    /// the list, empty.
    ///
    /// The rig's instances, lights and cameras are the first of their lists: posing does not change
    /// others that you append. Without a rig, [`AnimationChoice::All`] does nothing.
    ///
    /// # Errors
    /// [`SceneError::UnknownAnimation`] for a number beyond the list, [`SceneError::OutOfRange`]
    /// for a NaN time, [`SceneError::NotFinite`] if transforms overflow, and
    /// [`SceneError::NothingAtTime`] if no triangle is left. After the last two errors, pose the
    /// scene again before use.
    pub fn pose(&mut self, animation: AnimationChoice, time_s: f32) -> Result<(), SceneError> {
        apply::pose(self, animation, time_s)
    }
}

/// Whether a list begins with the items of `start`.
fn begins_with<'a>(
    mut list: impl Iterator<Item = &'a String>,
    mut start: impl Iterator<Item = &'a String>,
) -> bool {
    start.all(|item| list.next() == Some(item))
}
