//! The node hierarchy: where meshes, lights and cameras stand.

use glam::{Mat4, Quat, Vec3};
use gltf::camera::Projection;
use gltf::khr_lights_punctual::Kind;
use gltf::scene::Transform;

use super::{Loader, extras, name_or_index};
use crate::model::to_unit;
use crate::validate::is_invertible;
use crate::{Camera, Instance, Light, LightKind, SceneError};

impl Loader<'_> {
    /// Walks the default scene, or else the first; a file without scenes shows all root nodes.
    pub(super) fn load_nodes(&mut self) -> Result<(), SceneError> {
        let document = self.document;
        let nodes: Vec<_> = document.nodes().collect();
        let scene = document.default_scene().or_else(|| document.scenes().next());
        let roots: Vec<usize> = if let Some(scene) = scene {
            self.restore_environment(scene.extras());
            scene.nodes().map(|node| node.index()).collect()
        } else {
            let mut is_child = vec![false; nodes.len()];
            for child in nodes.iter().flat_map(gltf::Node::children) {
                is_child[child.index()] = true;
            }
            (0..nodes.len()).filter(|&i| !is_child[i]).collect()
        };
        // Nodes form trees: whoever is met twice has two parents or is its own ancestor.
        let mut met = vec![false; nodes.len()];
        let mut open: Vec<_> = roots.into_iter().rev().map(|root| (root, Mat4::IDENTITY)).collect();
        while let Some((index, world_from_parent)) = open.pop() {
            let node = &nodes[index];
            if std::mem::replace(&mut met[index], true) {
                let part = name_or_index(node.name(), "node", index);
                return Err(self.malformed(&part, "it is its own ancestor or has two parents"));
            }
            let world_from_local = world_from_parent * self.local_transform(node)?;
            self.load_node(node, world_from_local)?;
            let first_child = open.len();
            open.extend(node.children().map(|child| (child.index(), world_from_local)));
            // The last one is taken first: keep the file's order.
            open[first_child..].reverse();
        }
        Ok(())
    }

    fn local_transform(&self, node: &gltf::Node<'_>) -> Result<Mat4, SceneError> {
        let parent_from_local = match node.transform() {
            Transform::Matrix { matrix } => Mat4::from_cols_array_2d(&matrix),
            Transform::Decomposed { translation, rotation, scale } => {
                let rotation = Quat::from_array(rotation);
                let length = rotation.length();
                if length <= 0.0 {
                    let part = name_or_index(node.name(), "node", node.index());
                    return Err(
                        self.malformed(&part, "its rotation is a quaternion of length zero")
                    );
                }
                Mat4::from_scale_rotation_translation(
                    Vec3::from_array(scale),
                    rotation / length,
                    Vec3::from_array(translation),
                )
            }
        };
        if parent_from_local.is_finite() {
            return Ok(parent_from_local);
        }
        let part = format!("{}, its transform,", name_or_index(node.name(), "node", node.index()));
        Err(SceneError::NotFinite { file: self.file.to_owned(), part })
    }

    fn load_node(
        &mut self,
        node: &gltf::Node<'_>,
        world_from_local: Mat4,
    ) -> Result<(), SceneError> {
        let name = name_or_index(node.name(), "node", node.index());
        if !world_from_local.is_finite() {
            let part = format!("{name}, its transform to the world,");
            return Err(SceneError::NotFinite { file: self.file.to_owned(), part });
        }
        if let Some(mesh) = node.mesh() {
            self.load_mesh(&name, &mesh, world_from_local)?;
        }
        if let Some(light) = node.light() {
            let mut converted = convert_light(&light, world_from_local);
            extras::restore_light(&mut converted, light.extras());
            self.scene.lights.push(converted);
        }
        if let Some(camera) = node.camera() {
            match convert_camera(&camera, world_from_local) {
                Some(camera) => self.scene.cameras.push(camera),
                None => self.notes.warn(format!(
                    "camera {} at {name}: only perspective cameras with sensible numbers are \
                     supported, it was skipped",
                    camera.index()
                )),
            }
        }
        Ok(())
    }

    fn load_mesh(
        &mut self,
        node: &str,
        mesh: &gltf::Mesh<'_>,
        world_from_local: Mat4,
    ) -> Result<(), SceneError> {
        if !is_invertible(world_from_local) {
            self.notes.warn(format!("{node}: its mesh was skipped, for it is scaled to zero"));
            return Ok(());
        }
        let mirrored = world_from_local.as_dmat4().determinant() < 0.0;
        for primitive in mesh.primitives() {
            let material = self.material(&primitive.material())?;
            let Some(mesh) = self.primitive(mesh, &primitive, mirrored, material)? else {
                continue;
            };
            let left = self.budget.instances.checked_sub(1);
            self.budget.instances = left.ok_or_else(|| self.too_many(node, "instances"))?;
            self.scene.instances.push(Instance {
                name: node.to_owned(),
                mesh,
                material,
                world_from_local,
            });
        }
        Ok(())
    }
}

/// A direction of the node in the world; `None` where a scale of zero leaves none.
fn direction(world_from_local: Mat4, local: Vec3) -> Option<Vec3> {
    to_unit(world_from_local.transform_vector3(local))
}

/// Scale does not act on lights, the way of -z does (`KHR_lights_punctual`).
fn convert_light(light: &gltf::khr_lights_punctual::Light<'_>, world_from_local: Mat4) -> Light {
    let intensity = light.intensity();
    // The extension wants a range above zero; zero is a common "unlimited".
    let range_m = light.range().filter(|&range| range != 0.0);
    let kind = match light.kind() {
        Kind::Directional => {
            LightKind::Directional { illuminance_lux: intensity, angular_radius_rad: 0.0 }
        }
        Kind::Point => LightKind::Point { intensity_cd: intensity, range_m },
        Kind::Spot { inner_cone_angle, outer_cone_angle } => LightKind::Spot {
            intensity_cd: intensity,
            range_m,
            // Files with a hard edge have both equal, up to rounding.
            inner_angle_rad: inner_cone_angle.min(outer_cone_angle),
            outer_angle_rad: outer_cone_angle,
        },
    };
    Light {
        name: name_or_index(light.name(), "light", light.index()),
        kind,
        color: Vec3::from_array(light.color()),
        position: world_from_local.w_axis.truncate(),
        direction: direction(world_from_local, Vec3::NEG_Z).unwrap_or(Vec3::NEG_Z),
        radius_m: 0.0,
    }
}

fn convert_camera(camera: &gltf::Camera<'_>, world_from_local: Mat4) -> Option<Camera> {
    let Projection::Perspective(perspective) = camera.projection() else { return None };
    let forward = direction(world_from_local, Vec3::NEG_Z)?;
    let up = direction(world_from_local, Vec3::Y)?;
    let (fov, near_m) = (perspective.yfov(), perspective.znear());
    if !(fov > 0.0 && fov < std::f32::consts::PI && near_m > 0.0) {
        return None;
    }
    Some(Camera {
        name: name_or_index(camera.name(), "camera", camera.index()),
        position: world_from_local.w_axis.truncate(),
        forward,
        up,
        vertical_fov_rad: fov,
        near_m,
    })
}
