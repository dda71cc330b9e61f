//! Places on a map (see `load::origin`): nodes are moved in f64 before their transforms become f32.

use glam::{DMat4, DQuat, DVec3, Vec3};
use serde_json::Value;

use super::Loader;
use super::node::Tree;
use crate::load::origin::{FAR, origin_of, tell};
use crate::pose::{Interpolation, Local, Pose, Property};

impl Loader<'_> {
    /// Takes the scene's origin from the nodes, if their places are far from zero. `in_scene` nodes are the scene's own.
    pub(super) fn take_origin(&mut self, tree: &Tree, in_scene: usize) {
        let Ok(rough) = Pose::rest(&self.rig.nodes).file_from_node(&self.rig.nodes) else { return };
        let far = |place: Vec3| f64::from(place.abs().max_element()) >= FAR;
        let boxes: Vec<_> = (0..in_scene).map(|node| self.local_boxes(tree.number(node))).collect();
        let stores_far =
            boxes.iter().flatten().flatten().any(|corner| corner.abs().max_element() >= FAR);
        if !stores_far && !rough.iter().any(|matrix| far(matrix.w_axis.truncate())) {
            return;
        }
        let exact = self.exact_locals(tree);
        let mut from_node: Vec<DMat4> = Vec::with_capacity(exact.len());
        for (node, local) in self.rig.nodes.iter().zip(exact) {
            let from_parent = node.parent.map_or(DMat4::IDENTITY, |parent| from_node[parent]);
            from_node.push(from_parent * local);
        }
        let places = boxes.iter().zip(&from_node).flat_map(|(boxes, matrix)| {
            boxes.iter().flatten().map(|corner| matrix.transform_point3(*corner))
        });
        let origin = origin_of(|| places.clone());
        if origin == DVec3::ZERO {
            return;
        }
        self.move_nodes(tree, in_scene, &from_node, origin);
        tell(&mut self.notes, origin, stores_far);
        self.scene.origin = origin;
        if let Some(bounds) = &mut self.scene.grid_bounds {
            bounds.min = (bounds.min.as_dvec3() - origin).as_vec3();
            bounds.max = (bounds.max.as_dvec3() - origin).as_vec3();
        }
    }

    /// Two corners of the box around each primitive of a node's mesh.
    fn local_boxes(&self, number: usize) -> Vec<[DVec3; 2]> {
        let root = self.root();
        let Some(mesh) = root.nodes[number].mesh else { return Vec::new() };
        let positions = gltf::json::validation::Checked::Valid(gltf::Semantic::Positions);
        let corner = |value: &Option<Value>| {
            let numbers = value.as_ref()?.as_array()?;
            let at = |axis: usize| numbers.get(axis)?.as_f64();
            Some(DVec3::new(at(0)?, at(1)?, at(2)?))
        };
        let primitives = root.meshes[mesh.value()].primitives.iter();
        let accessors = primitives.filter_map(|primitive| primitive.attributes.get(&positions));
        let boxes = accessors.filter_map(|accessor| {
            let accessor = root.accessors.get(accessor.value())?;
            let corners = corner(&accessor.min).zip(corner(&accessor.max));
            // Normalized integers lie within 1.
            let corners = corners.filter(|_| !accessor.normalized).unwrap_or_default();
            Some(<[DVec3; 2]>::from(corners))
        });
        boxes.collect()
    }

    /// The rig's nodes as the JSON has them, in f64.
    fn exact_locals(&self, tree: &Tree) -> Vec<DMat4> {
        let document: Value = serde_json::from_slice(self.json).unwrap_or_default();
        let numbers = |value: &Value| -> Vec<f64> {
            value.as_array().into_iter().flatten().filter_map(Value::as_f64).collect()
        };
        let local = |(place, node): (usize, &crate::pose::Node)| {
            let json = &document["nodes"][tree.number(place)];
            match node.rest {
                Local::Matrix(rough) => match numbers(&json["matrix"]).try_into() {
                    Ok(matrix) => DMat4::from_cols_array(&matrix),
                    Err(_) => rough.as_dmat4(),
                },
                Local::Parts { translation, rotation, scale } => {
                    let vector = |key: &str, rough: Vec3| {
                        let exact = <[f64; 3]>::try_from(numbers(&json[key]));
                        exact.map_or(rough.as_dvec3(), DVec3::from_array)
                    };
                    // A turn that is rounded to f32 misses a place on the map by half a metre, too.
                    let turn = <[f64; 4]>::try_from(numbers(&json["rotation"])).ok();
                    let turn = turn.map(DQuat::from_array).filter(|turn| turn.length() > 0.0);
                    DMat4::from_scale_rotation_translation(
                        vector("scale", scale),
                        turn.map_or(rotation.as_dquat(), DQuat::normalize),
                        vector("translation", translation),
                    )
                }
            }
        };
        self.rig.nodes.iter().enumerate().map(local).collect()
    }

    /// Moves the nodes that are far, and what hangs below them along; and others with anything on them.
    fn move_nodes(&mut self, tree: &Tree, in_scene: usize, from_node: &[DMat4], origin: DVec3) {
        let mut has_moved = vec![false; from_node.len()];
        for node in 0..from_node.len() {
            let parent = self.rig.nodes[node].parent;
            if parent.is_some_and(|parent| has_moved[parent]) {
                has_moved[node] = true;
                continue;
            }
            let json = &self.root().nodes[tree.number(node)];
            let place = from_node[node].w_axis.truncate();
            let is_near = (place - origin).abs().max_element() < 0.25 * origin.abs().max_element();
            let ends = json.children.as_ref().is_none_or(Vec::is_empty);
            if !(is_near || ends || json.mesh.is_some() || node >= in_scene) {
                continue;
            }
            let from_parent = parent.map_or(DMat4::IDENTITY, |parent| from_node[parent]);
            let to_parent = from_parent.inverse();
            let (before, after) =
                (to_parent.transform_point3(place), to_parent.transform_point3(place - origin));
            if !after.is_finite() {
                continue;
            }
            has_moved[node] = true;
            match &mut self.rig.nodes[node].rest {
                Local::Matrix(matrix) => matrix.w_axis = after.as_vec3().extend(1.0),
                Local::Parts { translation, .. } => *translation = after.as_vec3(),
            }
            self.move_tracks(node, after - before);
        }
    }

    /// Moves the keys of a node's place.
    fn move_tracks(&mut self, node: usize, by: DVec3) {
        for channel in self.rig.animations.iter_mut().flat_map(|animation| &mut animation.channels)
        {
            if channel.node != node || channel.property != Property::Translation {
                continue;
            }
            let track = &mut channel.track;
            let is_cubic = track.interpolation == Interpolation::CubicSpline;
            let mut values = track.values.to_vec();
            for (index, value) in values.iter_mut().enumerate() {
                // Tangents stay.
                if !is_cubic || (index / 3) % 3 == 1 {
                    *value = (f64::from(*value) + by[index % 3]) as f32;
                }
            }
            track.values = values.into();
        }
    }
}
