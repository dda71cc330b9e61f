//! The node hierarchy, which places meshes, lights and cameras.

use std::sync::Arc;

use glam::{Mat4, Quat, Vec3};
use gltf::json::Root;
use gltf::scene::Transform;

use super::{Loader, name_or_index};
use crate::SceneError;
use crate::pose::{Local, Node, Pose, handedness, moving, weighing};

/// The file's nodes in the rig, and the mapping between their indices.
pub(super) struct Tree {
    /// The file's index of each of the rig's nodes.
    numbers: Vec<usize>,
    /// The rig's index of each of the file's nodes.
    places: Vec<Option<usize>>,
    /// The number of morph targets of each of the file's meshes.
    targets: Vec<usize>,
}

impl Tree {
    /// The file's index of one of the rig's nodes.
    pub(super) fn number(&self, place: usize) -> usize {
        self.numbers[place]
    }

    /// The rig's index of one of the file's nodes.
    pub(super) fn place(&self, number: usize) -> Option<usize> {
        self.places.get(number).copied().flatten()
    }

    /// The number of morph targets of the mesh of one of the rig's nodes.
    pub(super) fn targets(&self, root: &Root, place: usize) -> usize {
        let mesh = root.nodes[self.numbers[place]].mesh;
        mesh.map_or(0, |mesh| self.targets[mesh.value()])
    }
}

/// A node with something on it.
#[expect(clippy::struct_excessive_bools, reason = "what can be true of a node has no order")]
pub(super) struct Site {
    pub(super) name: Arc<str>,
    /// The node's index in the rig.
    pub(super) node: usize,
    /// The node's transform at rest.
    pub(super) world_from_node: Mat4,
    /// Whether the node's transform can keep handedness, and whether it can mirror, over all
    /// animations.
    pub(super) handedness: [bool; 2],
    /// `true` if an animation moves the node.
    pub(super) moves: bool,
    /// `true` if an animation changes the weights of its morph targets.
    pub(super) weighs: bool,
    /// `true` if an animation moves a joint of its mesh's skin.
    pub(super) bends: bool,
    /// `true` if the node or a node above it is hidden (`KHR_node_visibility`).
    pub(super) is_hidden: bool,
}

impl Loader<'_> {
    /// Loads everything on the nodes of a scene; see [`Loader::roots`].
    pub(super) fn load_nodes(&mut self, wanted: Option<&str>) -> Result<(), SceneError> {
        let nodes: Vec<_> = self.document.nodes().collect();
        let targets = self.document.meshes().map(|mesh| {
            mesh.primitives().map(|primitive| primitive.morph_targets().len()).max().unwrap_or(0)
        });
        let mut tree = Tree {
            numbers: Vec::new(),
            places: vec![None; nodes.len()],
            targets: targets.collect(),
        };
        for root in self.roots(wanted)? {
            self.walk(&nodes, root, &mut tree, true)?;
        }
        let in_scene = tree.numbers.len();
        self.walk_to_joints(&nodes, &mut tree)?;
        self.load_animations(&tree);
        self.take_origin(&tree, in_scene);

        let rig = &self.rig;
        let world_from_node =
            Pose::rest(&rig.nodes).file_from_node(&rig.nodes).map_err(|node| {
                let part = format!("{}, its transform to the world,", rig.nodes[node].name);
                SceneError::NotFinite { file: self.file.to_owned(), part }
            })?;
        let handedness = handedness(&rig.nodes, &rig.animations);
        let moves = moving(&rig.nodes, &rig.animations);
        let weighs = weighing(rig.nodes.len(), &rig.animations);
        let hidden = self.hidden(&nodes, &tree);
        for node in 0..in_scene {
            let gltf = &nodes[tree.numbers[node]];
            let bends = gltf.skin().is_some_and(|skin| {
                let mut places = skin.joints().filter_map(|joint| tree.place(joint.index()));
                places.any(|place| moves[place])
            });
            let site = Site {
                name: self.rig.nodes[node].name.clone(),
                node,
                world_from_node: world_from_node[node],
                handedness: handedness[node],
                moves: moves[node],
                weighs: weighs[node],
                bends,
                is_hidden: hidden[node],
            };
            if let Some(mesh) = gltf.mesh() {
                self.put_mesh(gltf, &mesh, &site, &tree)?;
            }
            // A hidden light does not shine; a scene's lights cannot be hidden.
            if let Some(light) = gltf.light() {
                if site.is_hidden {
                    self.notes.warn(format!(
                        "{}: its light was skipped, because it is hidden",
                        site.name
                    ));
                } else {
                    self.put_light(&light, gltf.name(), &site);
                }
            }
            if let Some(camera) = gltf.camera() {
                self.put_camera(&camera, gltf.name(), &site);
            }
        }
        Ok(())
    }

    /// Whether each of the rig's nodes is hidden, by itself or by a node above it.
    fn hidden(&self, nodes: &[gltf::Node<'_>], tree: &Tree) -> Vec<bool> {
        let mut hidden = Vec::with_capacity(tree.numbers.len());
        for (node, &number) in self.rig.nodes.iter().zip(&tree.numbers) {
            let visible = nodes[number]
                .extension_value("KHR_node_visibility")
                .and_then(|extension| extension.get("visible")?.as_bool());
            // Parents come before their children.
            let from_above = node.parent.is_some_and(|parent| hidden[parent]);
            hidden.push(from_above || visible == Some(false));
        }
        hidden
    }

    /// Adds a node and everything below it to the rig, parents first. Nodes form trees: a node that
    /// is met twice has two parents or is its own ancestor, which is an error.
    fn walk(
        &mut self,
        nodes: &[gltf::Node<'_>],
        root: usize,
        tree: &mut Tree,
        must_be_tree: bool,
    ) -> Result<(), SceneError> {
        let mut open = vec![(root, None)];
        while let Some((number, parent)) = open.pop() {
            let node = &nodes[number];
            if tree.places[number].is_some() {
                if !must_be_tree {
                    continue;
                }
                let part = name_or_index(node.name(), "node", number);
                return Err(self.malformed(&part, "it is its own ancestor or has two parents"));
            }
            let place = self.rig.nodes.len();
            tree.places[number] = Some(place);
            tree.numbers.push(number);
            let read = self.read_node(node, parent, tree)?;
            self.rig.nodes.push(read);
            let first_child = open.len();
            open.extend(node.children().map(|child| (child.index(), Some(place))));
            // The last child would be visited first; reversing keeps the file's order.
            open[first_child..].reverse();
        }
        Ok(())
    }

    /// Adds joints that are not nodes of the scene whose meshes they move, with their trees.
    fn walk_to_joints(
        &mut self,
        nodes: &[gltf::Node<'_>],
        tree: &mut Tree,
    ) -> Result<(), SceneError> {
        let joints: Vec<_> = (0..tree.numbers.len())
            .filter_map(|place| nodes[tree.numbers[place]].skin())
            .flat_map(|skin| skin.joints().map(|joint| joint.index()))
            .filter(|&joint| tree.places[joint].is_none())
            .collect();
        if joints.is_empty() {
            return Ok(());
        }
        let mut parents = vec![None; nodes.len()];
        for node in nodes {
            for child in node.children() {
                parents[child.index()] = Some(node.index());
            }
        }
        for joint in joints {
            if tree.places[joint].is_some() {
                continue;
            }
            // Nodes in a cycle have no root; any of them will do.
            let mut top = joint;
            for _ in 0..nodes.len() {
                let Some(parent) = parents[top] else { break };
                top = parent;
            }
            self.walk(nodes, top, tree, false)?;
            // The scene contains a part of this tree, but not the joint.
            if tree.places[joint].is_none() {
                self.walk(nodes, joint, tree, false)?;
            }
        }
        Ok(())
    }

    fn read_node(
        &mut self,
        node: &gltf::Node<'_>,
        parent: Option<usize>,
        tree: &Tree,
    ) -> Result<Node, SceneError> {
        let name = name_or_index(node.name(), "node", node.index());
        let not_finite = |what: &str| SceneError::NotFinite {
            file: self.file.to_owned(),
            part: format!("{name}, {what},"),
        };
        let json = &self.root().nodes[node.index()];
        let has_parts =
            json.translation.is_some() || json.rotation.is_some() || json.scale.is_some();
        if json.matrix.is_some() && has_parts {
            self.notes.warn(format!(
                "{name} has a matrix and also a translation, rotation or scale, which glTF forbids; \
                 the matrix counts"
            ));
        }
        let rest = match node.transform() {
            Transform::Matrix { matrix } => Local::Matrix(Mat4::from_cols_array_2d(&matrix)),
            Transform::Decomposed { translation, rotation, scale } => {
                let rotation = Quat::from_array(rotation);
                let length = rotation.length();
                if length <= 0.0 {
                    self.notes
                        .warn(format!("{name}: its rotation has length zero and was ignored"));
                }
                Local::Parts {
                    translation: Vec3::from_array(translation),
                    rotation: if length > 0.0 { rotation / length } else { Quat::IDENTITY },
                    scale: Vec3::from_array(scale),
                }
            }
        };
        if !rest.to_matrix().is_finite() {
            return Err(not_finite("its transform"));
        }
        let given = match node.mesh() {
            Some(mesh) => node.weights().or_else(|| mesh.weights()).unwrap_or(&[]),
            None => &[],
        };
        if given.iter().any(|weight| !weight.is_finite()) {
            return Err(not_finite("a weight of its morph targets"));
        }
        // Most weights are zero, and take no memory until an animation changes them.
        let given = if given.iter().any(|&weight| weight != 0.0) { given } else { &[] };
        let count = given.len().min(node.mesh().map_or(0, |mesh| tree.targets[mesh.index()]));
        self.spend_weights(&name, count)?;
        let weights = given[..count].to_vec();
        Ok(Node { name: name.into(), parent, rest, weights })
    }
    /// Charges weights to the limit: nodes share meshes and their weights, so a small file can ask
    /// for many.
    pub(super) fn spend_weights(&mut self, part: &str, count: usize) -> Result<(), SceneError> {
        let left = self.budget.weights.checked_sub(count);
        self.budget.weights =
            left.ok_or_else(|| self.too_many(part, "weights of morph targets"))?;
        Ok(())
    }
}
