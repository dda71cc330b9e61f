//! The scene, its bounds, and its transforms.

use std::collections::BTreeMap;

use glam::{DVec3, EulerRot, Mat4, Quat, Vec3};

use super::{Bounds, Camera, Environment, Instance, Light, Material, Mesh, Texture};
use crate::pose::Rig;

/// A scene: everything that a renderer needs.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Scene {
    /// The built-in scene's name, or the file's name without its extension.
    pub name: String,
    /// Triangles in local space.
    pub meshes: Vec<Mesh>,
    /// The instances: each is a mesh with a transform and a material.
    pub instances: Vec<Instance>,
    /// Surfaces.
    pub materials: Vec<Material>,
    /// Images.
    pub textures: Vec<Texture>,
    /// Lights.
    pub lights: Vec<Light>,
    /// Cameras; a file may have none, see [`Scene::default_camera`].
    pub cameras: Vec<Camera>,
    /// The surroundings.
    pub environment: Environment,
    /// Position of the scene's zero in the file's coordinates, in metres with y up. Default: zero.
    /// Map coordinates, such as UTM's, are far from zero, where 32-bit floats are off by half a
    /// metre, so readers subtract the origin in f64.
    pub origin: DVec3,
    /// The data of [`Scene::pose`]; `None` without animations. Setting it to `None` keeps the
    /// current pose and frees the memory.
    pub rig: Option<Rig>,
    /// The box that a voxel grid is fitted to. Default: `None`, which means [`Scene::bounds`]. A
    /// scene with this box may be empty.
    pub grid_bounds: Option<Bounds>,
    /// Notes of the loader.
    pub notes: LoadNotes,
}

/// Notes of the loader that are not errors.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct LoadNotes {
    /// The number of triangles without area that were removed from the meshes.
    pub degenerate_triangles: usize,
    /// Sentences for the user, each naming something that was ignored or replaced.
    pub warnings: Vec<String>,
    /// The program that wrote the file, if the file names it.
    pub generator: Option<String>,
    /// The extensions of the format that the file uses (glTF), understood or not.
    pub extensions_used: Vec<String>,
    /// The extensions that the file requires.
    pub extensions_required: Vec<String>,
    /// The file's scenes in order, by their names or numbers (glTF, VXCT); see
    /// [`LoadOptions::scene`](crate::LoadOptions::scene).
    pub scenes: Vec<String>,
    /// The names of nodes whose light or camera has another name, and that name (glTF); see
    /// [`Scene::name_on`].
    pub nodes: BTreeMap<String, String>,
}

/// Bounding boxes of a scene's instances. A caller that stores them only has to update those of
/// instances that move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct InstanceBounds {
    boxes: Vec<Bounds>,
}

impl InstanceBounds {
    /// Measures all instances of a scene, hidden ones included.
    pub fn of(scene: &Scene) -> Self {
        let boxes = scene.instances.iter().map(|instance| scene.bounds_of(instance));
        Self { boxes: boxes.collect() }
    }

    /// Updates the box of an instance after it has moved or its mesh has changed.
    pub fn follow(&mut self, scene: &Scene, instance: usize) {
        if let (Some(place), Some(instance)) =
            (self.boxes.get_mut(instance), scene.instances.get(instance))
        {
            *place = scene.bounds_of(instance);
        }
    }

    /// The box around an instance; [`Bounds::EMPTY`] if it does not exist.
    pub fn get(&self, instance: usize) -> Bounds {
        self.boxes.get(instance).copied().unwrap_or(Bounds::EMPTY)
    }

    /// The box around the scene, as [`Scene::bounds`] computes it.
    pub fn all(&self, scene: &Scene) -> Bounds {
        let (mut subjects, mut shown) = (Bounds::EMPTY, Bounds::EMPTY);
        for (instance, bounds) in scene.instances.iter().zip(&self.boxes) {
            if instance.is_hidden {
                continue;
            }
            shown = shown.union(*bounds);
            if !instance.is_backdrop {
                subjects = subjects.union(*bounds);
            }
        }
        if subjects.is_empty() { shown } else { subjects }
    }
}

impl Scene {
    /// The name of the light or camera on the file's node `node`; `node` itself if there is none.
    pub fn name_on<'a>(&'a self, node: &'a str) -> &'a str {
        self.notes.nodes.get(node).map_or(node, String::as_str)
    }

    /// Converts a position to the file's coordinates, m: as the shortest decimals, or rounded to a
    /// micrometre if [`Scene::origin`] is not zero.
    pub fn to_file(&self, place: Vec3) -> DVec3 {
        if self.origin == DVec3::ZERO {
            // The shortest decimal that parses as this f32.
            let decimal = |number: f32| number.to_string().parse().unwrap_or(f64::from(number));
            return DVec3::from_array(place.to_array().map(decimal));
        }
        ((place.as_dvec3() + self.origin) * 1e6).round() / 1e6
    }

    /// Converts a position in the file's coordinates, m, to the scene's.
    pub fn from_file(&self, place: DVec3) -> Vec3 {
        (place - self.origin).as_vec3()
    }

    /// The instances that are not hidden.
    pub fn shown(&self) -> impl Iterator<Item = &Instance> {
        self.instances.iter().filter(|instance| !instance.is_hidden)
    }

    /// The subject of the scene: the instances that are neither hidden nor a backdrop.
    pub fn subjects(&self) -> impl Iterator<Item = &Instance> {
        self.shown().filter(|instance| !instance.is_backdrop)
    }

    /// The smallest box around all instances that are neither hidden nor a backdrop, in world
    /// space; [`Bounds::EMPTY`] without triangles. If there is only a backdrop, its box counts.
    pub fn bounds(&self) -> Bounds {
        InstanceBounds::of(self).all(self)
    }

    /// The smallest box around the triangles of an instance, in world space.
    fn bounds_of(&self, instance: &Instance) -> Bounds {
        let mut bounds = Bounds::EMPTY;
        let Some(mesh) = self.meshes.get(instance.mesh) else { return bounds };
        for &index in &mesh.indices {
            if let Some(&position) = mesh.positions.get(index as usize) {
                bounds.include(instance.world_from_local.transform_point3(position));
            }
        }
        bounds
    }

    /// Whether the scene's colours are display values, as in scenes for VXCT: some light has an
    /// [`Attenuation`](crate::Attenuation), or the scene has its own grid and no lights.
    pub fn has_display_values(&self) -> bool {
        let has_no_lights = self.lights.is_empty() && self.grid_bounds.is_some();
        has_no_lights || self.lights.iter().any(|light| light.attenuation.is_some())
    }

    /// The box that a voxel grid is fitted to: [`Scene::grid_bounds`], or else [`Scene::bounds`].
    pub fn voxel_bounds(&self) -> Bounds {
        self.grid_bounds.unwrap_or_else(|| self.bounds())
    }

    /// The number of triangles that are drawn: the sum over the instances that are not hidden.
    pub fn triangle_count(&self) -> usize {
        self.shown()
            .filter_map(|instance| self.meshes.get(instance.mesh))
            .map(Mesh::triangle_count)
            .sum()
    }

    /// Moves everything, lights and cameras included, by a rigid motion (rotation and translation;
    /// scale would change distances to lights and so their effect). The surroundings stay. The
    /// axis-aligned box of the voxels grows to hold its old content.
    pub fn transform(&mut self, rigid: Mat4) {
        if let Some(rig) = &mut self.rig {
            rig.transform(rigid);
        }
        if let Some(bounds) = &mut self.grid_bounds {
            *bounds = Bounds::from_points(bounds.corners().map(|c| rigid.transform_point3(c)));
        }
        for instance in &mut self.instances {
            instance.world_from_local = rigid * instance.world_from_local;
        }
        for light in &mut self.lights {
            light.position = rigid.transform_point3(light.position);
            light.direction = rigid.transform_vector3(light.direction).normalize_or_zero();
        }
        for camera in &mut self.cameras {
            camera.position = rigid.transform_point3(camera.position);
            camera.forward = rigid.transform_vector3(camera.forward).normalize_or_zero();
            camera.up = rigid.transform_vector3(camera.up).normalize_or_zero();
        }
    }

    /// Rotates everything that [`Scene::transform`] moves about the centre of the voxels' bounds:
    /// Euler angles in radians about x, y and z (intrinsic, in that order).
    ///
    /// Pictures from the scene's own cameras stay the same, except for the surroundings and the
    /// alignment of walls to voxels.
    pub fn rotate(&mut self, angles_rad: Vec3) {
        let turn = Quat::from_euler(EulerRot::XYZ, angles_rad.x, angles_rad.y, angles_rad.z);
        let center = self.voxel_bounds().center();
        let from_center = Mat4::from_translation(center) * Mat4::from_quat(turn);
        self.transform(from_center * Mat4::from_translation(-center));
    }
}
