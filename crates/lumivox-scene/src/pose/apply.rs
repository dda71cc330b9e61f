//! Applies a pose to the scene.

use std::path::Path;
use std::sync::Arc;

use glam::Mat4;

use super::rig::{Animation, Parts, Pose, Property, moving};
use super::{AnimationChoice, Rig, place_camera, place_light};
use crate::validate::invertible;
use crate::{Instance, Scene, SceneError};

pub(super) fn pose(
    scene: &mut Scene,
    choice: AnimationChoice,
    time_s: f32,
) -> Result<(), SceneError> {
    let file = match &scene.rig {
        Some(rig) => rig.parts.file.clone(),
        None => scene.name.clone().into(),
    };
    if time_s.is_nan() {
        return Err(SceneError::OutOfRange {
            file,
            part: "the time".to_owned(),
            value: time_s.to_string(),
            expected: "a number of seconds".to_owned(),
        });
    }
    let animations = scene.rig.as_ref().map_or(&[][..], |rig| &rig.parts.animations);
    let known = || animations.iter().map(|animation| animation.name.clone()).collect();
    let playing = match choice {
        AnimationChoice::All => animations,
        AnimationChoice::One(index) => match animations.get(index) {
            Some(animation) => std::slice::from_ref(animation),
            None => return Err(SceneError::UnknownAnimation { file, index, known: known() }),
        },
    };
    let Some(rig) = &scene.rig else { return Ok(()) };
    let mut pose = Pose::rest(&rig.parts.nodes);
    for animation in playing {
        pose.play(animation, time_s);
    }
    if let Some(mut rig) = scene.rig.take() {
        let shown = show(&mut rig, &pose, scene);
        scene.rig = Some(rig);
        shown?;
    }
    if scene.triangle_count() > 0 || scene.grid_bounds.is_some() {
        return Ok(());
    }
    Err(SceneError::NothingAtTime { file, time_s })
}

impl Rig {
    /// Puts a freshly loaded scene into the file's rest pose, with instances, lights and cameras of
    /// `parts`. The rig stays with the scene if there are animations.
    pub(crate) fn install(scene: &mut Scene, parts: Parts) -> Result<(), SceneError> {
        let pose = Pose::rest(&parts.nodes);
        let mut rig = Self {
            parts: Arc::new(parts),
            world_from_file: Mat4::IDENTITY,
            shown: Vec::new(),
            has_own_lights: false,
            has_own_cameras: false,
        };
        show(&mut rig, &pose, scene)?;
        if !rig.parts.animations.is_empty() {
            rig.drop_what_never_moves();
            scene.rig = Some(rig);
        }
        Ok(())
    }

    /// Drops the deformation data of meshes that no animation deforms: their shape is final.
    fn drop_what_never_moves(&mut self) {
        // The rig is new, so nothing else owns its parts.
        let Some(parts) = Arc::get_mut(&mut self.parts) else { return };
        let moves = moving(&parts.nodes, &parts.animations);
        let weighs = weighing(parts.nodes.len(), &parts.animations);
        let skins = &parts.skins;
        parts.deformed.retain(|deformed| {
            let bends =
                deformed.skin.is_some_and(|skin| skins[skin].joints.iter().any(|&j| moves[j]));
            bends || weighs[deformed.node]
        });
    }

    /// Appends a transform to `world_from_file`, for all later poses.
    pub(crate) fn transform(&mut self, world_from_world: Mat4) {
        self.world_from_file = world_from_world * self.world_from_file;
    }

    /// Updates the indices after one of the scene's instances was removed.
    pub(crate) fn forget_instance(&mut self, index: usize) {
        if index < self.shown.len() {
            self.shown.remove(index);
        }
    }
}

/// For each node, whether an animation changes the weights of its morph targets.
pub(crate) fn weighing(nodes: usize, animations: &[Animation]) -> Vec<bool> {
    let mut weighs = vec![false; nodes];
    for channel in animations.iter().flat_map(|animation| &animation.channels) {
        weighs[channel.node] |= channel.property == Property::Weights;
    }
    weighs
}

fn show(rig: &mut Rig, pose: &Pose, scene: &mut Scene) -> Result<(), SceneError> {
    let parts = Arc::clone(&rig.parts);
    let file_from_node = pose.file_from_node(&parts.nodes).map_err(|node| {
        not_finite(&parts.file, format!("{}, its transform to the world,", parts.nodes[node].name))
    })?;
    deform(&parts, pose, &file_from_node, scene)?;
    place_instances(rig, &parts, &file_from_node, scene)?;
    if !rig.has_own_lights {
        for (light, &node) in scene.lights.iter_mut().zip(&parts.lights) {
            place_light(light, rig.world_from_file * file_from_node[node]);
        }
    }
    if !rig.has_own_cameras {
        for (camera, &node) in scene.cameras.iter_mut().zip(&parts.cameras) {
            place_camera(camera, rig.world_from_file * file_from_node[node]);
        }
    }
    Ok(())
}

fn not_finite(file: &Path, part: String) -> SceneError {
    SceneError::NotFinite { file: file.to_owned(), part }
}

fn deform(
    parts: &Parts,
    pose: &Pose,
    file_from_node: &[Mat4],
    scene: &mut Scene,
) -> Result<(), SceneError> {
    // Several meshes often share a skin.
    let mut joints = vec![None; parts.skins.len()];
    for deformed in &parts.deformed {
        let Some(mesh) = scene.meshes.get_mut(deformed.mesh) else { continue };
        let joints = deformed.skin.map(|skin| {
            &*joints[skin].get_or_insert_with(|| parts.skins[skin].file_from_mesh(file_from_node))
        });
        if !deformed.deform(&pose.weights[deformed.node], joints.map(Vec::as_slice), mesh) {
            let part = format!("mesh \"{}\", deformed by morph targets or bones,", mesh.name);
            return Err(not_finite(&parts.file, part));
        }
    }
    Ok(())
}

/// Updates the scene's first instances. Indices stay while the set of visible instances does.
fn place_instances(
    rig: &mut Rig,
    parts: &Parts,
    file_from_node: &[Mat4],
    scene: &mut Scene,
) -> Result<(), SceneError> {
    let mut visible = Vec::with_capacity(parts.instances.len());
    for (i, placed) in parts.instances.iter().enumerate() {
        let world_from_local = rig.world_from_file * placed.file_from_local(file_from_node);
        if !world_from_local.is_finite() {
            let part = format!("instance \"{}\", its transform,", placed.name);
            return Err(not_finite(&parts.file, part));
        }
        let [upright, mirrored] = placed.meshes;
        let Some(world_from_local) = invertible(world_from_local, upright.is_none()) else {
            continue;
        };
        let mirrors = world_from_local.as_dmat4().determinant() < 0.0;
        // Rounding may flip the sign of the determinant of almost flat transforms, which must stay
        // visible.
        let mesh = if mirrors { mirrored.or(upright) } else { upright.or(mirrored) };
        let Some(mesh) = mesh else { continue };
        if scene.meshes.get(mesh).is_some_and(|mesh| !mesh.indices.is_empty()) {
            visible.push((i, mesh, world_from_local));
        }
    }
    if !visible.iter().map(|v| v.0).eq(rig.shown.iter().copied()) {
        let others = scene.instances.split_off(rig.shown.len().min(scene.instances.len()));
        // Instances that stay visible keep their flags.
        let mut marked = rig.shown.iter().zip(&scene.instances).peekable();
        let again = visible.iter().map(|&(i, mesh, world_from_local)| {
            while marked.next_if(|(shown, _)| **shown < i).is_some() {}
            match marked.next_if(|(shown, _)| **shown == i) {
                Some((_, instance)) => Instance { mesh, world_from_local, ..instance.clone() },
                None => parts.instances[i].instance(mesh, world_from_local),
            }
        });
        scene.instances = again.collect();
        scene.instances.extend(others);
        rig.shown = visible.iter().map(|v| v.0).collect();
        return Ok(());
    }
    for (instance, (_, mesh, world_from_local)) in scene.instances.iter_mut().zip(visible) {
        instance.mesh = mesh;
        instance.world_from_local = world_from_local;
    }
    Ok(())
}
