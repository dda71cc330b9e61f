//! Map coordinates (see `load::origin`): nodes are moved in f64 before their transforms become f32.

use glam::{DMat4, DQuat, DVec3, Vec3};
use serde_json::Value;

use super::Loader;
use super::node::Tree;
use crate::load::origin::{FAR, origin_of, tell_lost};
use crate::pose::{Interpolation, Local, Pose, Property, moving};

impl Loader<'_> {
    /// Subtracts an origin from the nodes, if they are far from zero. The first `in_scene` nodes
    /// belong to the scene.
    pub(super) fn take_origin(&mut self, tree: &Tree, in_scene: usize) {
        let Ok(rough) = Pose::rest(&self.rig.nodes).file_from_node(&self.rig.nodes) else { return };
        let far = |place: Vec3| f64::from(place.abs().max_element()) >= FAR;
        let boxes: Vec<_> = (0..in_scene).map(|node| self.local_boxes(tree.number(node))).collect();
        let joints: Vec<_> = (0..in_scene).map(|node| self.joints(tree, node)).collect();
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
        // A skinned mesh is placed by its joints, not by its node.
        let places =
            boxes.iter().zip(&from_node).zip(&joints).flat_map(|((boxes, matrix), joints)| {
                let corners = boxes.iter().flatten().filter(|_| joints.is_empty());
                let corners = corners.map(|corner| matrix.transform_point3(*corner));
                corners.chain(joints.iter().map(|&joint| from_node[joint].w_axis.truncate()))
            });
        let origin = origin_of(|| places.clone());
        if origin == DVec3::ZERO {
            return;
        }
        let have_far_keys = self.move_nodes(tree, in_scene, &from_node, origin);
        if stores_far || have_far_keys {
            tell_lost(&mut self.notes, origin);
        }
        self.scene.origin = origin;
        if let Some(bounds) = &mut self.scene.grid_bounds {
            bounds.min = (bounds.min.as_dvec3() - origin).as_vec3();
            bounds.max = (bounds.max.as_dvec3() - origin).as_vec3();
        }
    }

    /// The rig's indices of the joints of a node's skin.
    fn joints(&self, tree: &Tree, node: usize) -> Vec<usize> {
        let root = self.root();
        let json = &root.nodes[tree.number(node)];
        let skin = json.skin.filter(|_| json.mesh.is_some());
        let joints = skin.and_then(|skin| root.skins.get(skin.value())).map(|skin| &skin.joints);
        joints.into_iter().flatten().filter_map(|joint| tree.place(joint.value())).collect()
    }

    /// Two corners of the box around each primitive of a node's mesh, or around all of its copies.
    fn local_boxes(&self, number: usize) -> Vec<[DVec3; 2]> {
        let root = self.root();
        let Some(mesh) = root.nodes[number].mesh else { return Vec::new() };
        let positions = gltf::json::validation::Checked::Valid(gltf::Semantic::Positions);
        let primitives = root.meshes[mesh.value()].primitives.iter();
        let accessors = primitives.filter_map(|primitive| primitive.attributes.get(&positions));
        let boxes = accessors.filter_map(|accessor| self.box_of(accessor.value()));
        let extension = root.nodes[number].extensions.as_ref();
        let copies = extension.and_then(|e| e.others.get("EXT_mesh_gpu_instancing"));
        let copies = copies.and_then(|copies| copies["attributes"]["TRANSLATION"].as_u64());
        let copies = copies.and_then(|copies| self.box_of(usize::try_from(copies).ok()?));
        let [low, high] = copies.unwrap_or_default();
        boxes.map(|corners| [corners[0] + low, corners[1] + high]).collect()
    }

    /// The box of an accessor's vectors, from its bounds or else from its values.
    fn box_of(&self, index: usize) -> Option<[DVec3; 2]> {
        let accessor = self.root().accessors.get(index)?;
        let corner = |value: &Option<Value>| {
            let numbers = value.as_ref()?.as_array()?;
            let at = |axis: usize| numbers.get(axis)?.as_f64();
            Some(DVec3::new(at(0)?, at(1)?, at(2)?))
        };
        // Normalized integers lie within 1.
        if accessor.normalized {
            return Some([DVec3::ZERO; 2]);
        }
        if let (Some(low), Some(high)) = (corner(&accessor.min), corner(&accessor.max)) {
            return Some([low, high]);
        }
        let numbers = self.read_floats::<3>(index, "places").ok()?;
        let places = numbers.iter().map(|&place| Vec3::from_array(place).as_dvec3());
        places.fold(None, |corners: Option<[DVec3; 2]>, place| {
            let [low, high] = corners.unwrap_or([place; 2]);
            Some([low.min(place), high.max(place)])
        })
    }

    /// The transforms of the rig's nodes to their parents, read from the JSON in f64.
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
                    // A rotation rounded to f32 would also shift map coordinates by half a metre.
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

    /// Subtracts the origin from far nodes, which moves their descendants, and from other nodes
    /// with anything on them. Returns whether keys of animations were far.
    fn move_nodes(
        &mut self,
        tree: &Tree,
        in_scene: usize,
        from_node: &[DMat4],
        origin: DVec3,
    ) -> bool {
        // Animated nodes are moved themselves: moving a child's rest transform would rotate the
        // shift.
        let moves = moving(&self.rig.nodes, &self.rig.animations);
        let mut have_far_keys = false;
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
            if !(is_near || ends || moves[node] || json.mesh.is_some() || node >= in_scene) {
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
            have_far_keys |= self.move_tracks(node, after - before);
        }
        have_far_keys
    }

    /// Moves the translation keys of a node; returns whether they were far.
    fn move_tracks(&mut self, node: usize, by: DVec3) -> bool {
        let mut were_far = false;
        for channel in self.rig.animations.iter_mut().flat_map(|animation| &mut animation.channels)
        {
            if channel.node != node || channel.property != Property::Translation {
                continue;
            }
            let track = &mut channel.track;
            let is_cubic = track.interpolation == Interpolation::CubicSpline;
            let mut values = track.values.to_vec();
            were_far |= values.iter().any(|value| f64::from(value.abs()) >= FAR);
            for (index, value) in values.iter_mut().enumerate() {
                // Tangents are differences, which do not change.
                if !is_cubic || (index / 3) % 3 == 1 {
                    *value = (f64::from(*value) + by[index % 3]) as f32;
                }
            }
            track.values = values.into();
        }
        were_far
    }
}
