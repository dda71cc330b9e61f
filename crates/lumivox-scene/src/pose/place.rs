//! Moves lights and cameras to their nodes.

use glam::{Mat4, Vec3};

use crate::model::to_unit;
use crate::validate::invertible;
use crate::{Camera, Light};

/// A node's local direction in the world; `None` if the node is scaled to zero.
fn direction(world_from_node: Mat4, local: Vec3) -> Option<Vec3> {
    let placed = invertible(world_from_node, false).unwrap_or(world_from_node);
    to_unit(placed.transform_vector3(local))
}

/// Places a light, which shines along its node's -z; scale is ignored (`KHR_lights_punctual`).
pub(crate) fn place_light(light: &mut Light, world_from_node: Mat4) {
    light.position = world_from_node.w_axis.truncate();
    light.direction = direction(world_from_node, Vec3::NEG_Z).unwrap_or(Vec3::NEG_Z);
}

/// Places a camera, which looks along its node's -z, with +y at the top (glTF 2.0, section 3.10.2).
/// If a scale of zero leaves no direction, the world's axes are used, and the result is `false`.
pub(crate) fn place_camera(camera: &mut Camera, world_from_node: Mat4) -> bool {
    camera.position = world_from_node.w_axis.truncate();
    let axes = (direction(world_from_node, Vec3::NEG_Z), direction(world_from_node, Vec3::Y));
    let (forward, up) = match axes {
        (Some(forward), Some(up)) => (forward, up),
        _ => (Vec3::NEG_Z, Vec3::Y),
    };
    camera.forward = forward;
    camera.up = up;
    axes.0.is_some() && axes.1.is_some()
}
