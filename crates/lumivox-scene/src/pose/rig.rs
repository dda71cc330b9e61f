//! The data of animations: the tree of nodes, the channels, and the things on the nodes.

use std::path::PathBuf;
use std::sync::Arc;

use glam::{Affine3A, Mat4, Quat, Vec3};

use super::deform::Deformed;
use super::sampler::Track;
use crate::Instance;

/// The data of posing that never change.
#[derive(Debug, Default, PartialEq)]
pub(crate) struct Parts {
    /// The file's name, for messages.
    pub(crate) file: PathBuf,
    /// The nodes; parents come before their children.
    pub(crate) nodes: Vec<Node>,
    pub(crate) animations: Vec<Animation>,
    pub(crate) skins: Vec<Skin>,
    /// Meshes whose vertices move.
    pub(crate) deformed: Vec<Deformed>,
    pub(crate) instances: Vec<Placed>,
    /// The nodes of the scene's first lights.
    pub(crate) lights: Vec<usize>,
    /// The nodes of the scene's first cameras.
    pub(crate) cameras: Vec<usize>,
}

/// A node of the tree.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Node {
    /// The node's name, for messages.
    pub(crate) name: Arc<str>,
    /// The index of its parent, which comes before it.
    pub(crate) parent: Option<usize>,
    /// Its transform at rest.
    pub(crate) rest: Local,
    /// The weights of its mesh's morph targets at rest; empty without targets.
    pub(crate) weights: Vec<f32>,
}

/// A node's transform to its parent.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Local {
    /// A matrix, which cannot be animated.
    Matrix(Mat4),
    /// Scale, then rotation (a unit quaternion), then translation.
    Parts { translation: Vec3, rotation: Quat, scale: Vec3 },
}

impl Local {
    pub(crate) fn to_matrix(self) -> Mat4 {
        match self {
            Self::Matrix(matrix) => matrix,
            Self::Parts { translation, rotation, scale } => {
                Mat4::from_scale_rotation_translation(scale, rotation, translation)
            }
        }
    }
}

/// A named set of channels.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Animation {
    pub(crate) name: String,
    /// The time of the last key of all channels.
    pub(crate) duration_s: f32,
    pub(crate) channels: Vec<Channel>,
}

/// Values over time for one property of a node.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Channel {
    pub(crate) node: usize,
    pub(crate) property: Property,
    pub(crate) track: Track,
}

/// The animated property of a node.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Property {
    Translation,
    Rotation,
    Scale,
    Weights,
}

/// Bones: nodes that move vertices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Skin {
    pub(crate) joints: Vec<usize>,
    /// The transform from the mesh's space to that of each joint.
    pub(crate) joint_from_mesh: Vec<Mat4>,
}

/// An instance and its node.
#[expect(clippy::struct_excessive_bools, reason = "as the scene's instances have them")]
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Placed {
    pub(crate) name: Arc<str>,
    /// `None` for skinned meshes, whose joints place them.
    pub(crate) node: Option<usize>,
    /// The transform of one of many copies on its node (`EXT_mesh_gpu_instancing`).
    pub(crate) node_from_local: Option<Mat4>,
    /// The scene's meshes for transforms that do not mirror and that do; `None` if that never
    /// happens.
    pub(crate) meshes: [Option<usize>; 2],
    pub(crate) material: usize,
    /// `true` if no animation moves it, and the file does not mark it as dynamic.
    pub(crate) is_static: bool,
    /// `false` if the file excludes it from the voxels.
    pub(crate) is_voxelized: bool,
    /// `true` if the file hides it.
    pub(crate) is_hidden: bool,
    /// `true` if the file marks it as surroundings.
    pub(crate) is_backdrop: bool,
}

impl Placed {
    /// The transform from the mesh to the file's root.
    pub(crate) fn file_from_local(&self, file_from_node: &[Mat4]) -> Mat4 {
        let file_from_node = self.node.map_or(Mat4::IDENTITY, |node| file_from_node[node]);
        self.node_from_local.map_or(file_from_node, |local| file_from_node * local)
    }

    /// Makes the scene's instance, with the file's marks.
    pub(crate) fn instance(&self, mesh: usize, world_from_local: Mat4) -> Instance {
        Instance {
            name: self.name.to_string(),
            mesh,
            material: self.material,
            world_from_local,
            is_static: self.is_static,
            is_voxelized: self.is_voxelized,
            is_hidden: self.is_hidden,
            is_backdrop: self.is_backdrop,
        }
    }
}

/// All nodes at one time.
pub(crate) struct Pose {
    local: Vec<Local>,
    /// The weights of each node's morph targets.
    pub(crate) weights: Vec<Vec<f32>>,
}

impl Pose {
    /// The rest pose, as the file stores it.
    pub(crate) fn rest(nodes: &[Node]) -> Self {
        Self {
            local: nodes.iter().map(|node| node.rest).collect(),
            weights: nodes.iter().map(|node| node.weights.clone()).collect(),
        }
    }

    /// Moves the properties that the animation's channels name, at a time within its range.
    pub(crate) fn play(&mut self, animation: &Animation, time_s: f32) {
        let time_s = time_s.clamp(0.0, animation.duration_s);
        for Channel { node, property, track } in &animation.channels {
            let Local::Parts { translation, rotation, scale } = &mut self.local[*node] else {
                // On a node with a matrix, only weights can be animated.
                if *property == Property::Weights {
                    track.sample(time_s, &mut self.weights[*node]);
                }
                continue;
            };
            match property {
                Property::Translation => *translation = track.sample_vec3(time_s),
                Property::Rotation => *rotation = track.sample_rotation(time_s),
                Property::Scale => *scale = track.sample_vec3(time_s),
                Property::Weights => track.sample(time_s, &mut self.weights[*node]),
            }
        }
    }

    /// The transform from each node to the file's root; or the first node whose transform
    /// overflows.
    pub(crate) fn file_from_node(&self, nodes: &[Node]) -> Result<Vec<Mat4>, usize> {
        let mut file_from_node: Vec<Mat4> = Vec::with_capacity(nodes.len());
        for (i, (node, local)) in nodes.iter().zip(&self.local).enumerate() {
            let from_parent = node.parent.map_or(Mat4::IDENTITY, |parent| file_from_node[parent]);
            let matrix = from_parent * local.to_matrix();
            if !matrix.is_finite() {
                return Err(i);
            }
            file_from_node.push(matrix);
        }
        Ok(file_from_node)
    }
}

impl Skin {
    /// The matrices that move vertices from the mesh's space to the file's root, joint by joint
    /// (glTF 2.0, section 3.7.3.3).
    pub(crate) fn file_from_mesh(&self, file_from_node: &[Mat4]) -> Vec<Affine3A> {
        let joints = self.joints.iter().zip(&self.joint_from_mesh);
        joints.map(|(&joint, &bind)| Affine3A::from_mat4(file_from_node[joint] * bind)).collect()
    }
}

/// Whether a node's transform to the file can keep handedness at some time, and whether it can
/// mirror: the sign of the determinant is the product of the scales' signs up the tree.
pub(crate) fn handedness(nodes: &[Node], animations: &[Animation]) -> Vec<[bool; 2]> {
    let mut ranges: Vec<Option<[(f32, f32); 3]>> = nodes
        .iter()
        .map(|node| match node.rest {
            Local::Parts { scale, .. } => Some(scale.to_array().map(|s| (s, s))),
            Local::Matrix(_) => None,
        })
        .collect();
    for channel in animations.iter().flat_map(|animation| &animation.channels) {
        if channel.property == Property::Scale
            && let Some(range) = &mut ranges[channel.node]
        {
            for (axis, range) in range.iter_mut().enumerate() {
                let (low, high) = channel.track.range(axis);
                *range = (range.0.min(low), range.1.max(high));
            }
        }
    }
    let both = |a: [bool; 2], b: [bool; 2]| -> [bool; 2] {
        [(a[0] && b[0]) || (a[1] && b[1]), (a[0] && b[1]) || (a[1] && b[0])]
    };
    let mut result: Vec<[bool; 2]> = Vec::with_capacity(nodes.len());
    for (node, range) in nodes.iter().zip(ranges) {
        let own = match (range, node.rest) {
            (Some(axes), _) => axes
                .map(|(low, high)| [high > 0.0 || low >= 0.0, low < 0.0])
                .into_iter()
                .fold([true, false], both),
            (None, local) => {
                let mirrors = local.to_matrix().as_dmat4().determinant() < 0.0;
                [!mirrors, mirrors]
            }
        };
        result.push(node.parent.map_or(own, |parent| both(result[parent], own)));
    }
    result
}

/// For each node, whether it moves at some time, by itself or with a node above it.
pub(crate) fn moving(nodes: &[Node], animations: &[Animation]) -> Vec<bool> {
    let mut moves = vec![false; nodes.len()];
    for channel in animations.iter().flat_map(|animation| &animation.channels) {
        if channel.property != Property::Weights {
            moves[channel.node] = true;
        }
    }
    for (i, node) in nodes.iter().enumerate() {
        moves[i] |= node.parent.is_some_and(|parent| moves[parent]);
    }
    moves
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::pose::sampler::Interpolation;

    fn node(parent: Option<usize>, scale: Vec3) -> Node {
        let rest = Local::Parts { translation: Vec3::X, rotation: Quat::IDENTITY, scale };
        Node { name: "n".into(), parent, rest, weights: Vec::new() }
    }

    fn scaling(node: usize, keys: [[f32; 3]; 2]) -> Animation {
        let track = Track {
            times_s: [0.0, 1.0].into(),
            values: keys.as_flattened().into(),
            components: 3,
            interpolation: Interpolation::Linear,
        };
        let channel = Channel { node, property: Property::Scale, track };
        Animation { name: "a".to_owned(), duration_s: 1.0, channels: vec![channel] }
    }

    #[test]
    fn handedness_follows_the_signs_of_scales() {
        let nodes = [
            node(None, Vec3::new(-1.0, 1.0, 1.0)),
            node(Some(0), Vec3::ONE),
            node(Some(1), Vec3::new(1.0, -2.0, 1.0)),
            node(Some(1), Vec3::ZERO),
        ];
        let (keeps, mirrors, either) = ([true, false], [false, true], [true, true]);
        assert_eq!(handedness(&nodes, &[]), [mirrors, mirrors, keeps, mirrors]);
        // A scale that begins at zero keeps its sign; a scale that passes through zero changes it.
        let grow = scaling(1, [[0.0; 3], [2.0; 3]]);
        assert_eq!(handedness(&nodes, &[grow]), [mirrors, mirrors, keeps, mirrors]);
        let flip = scaling(1, [[1.0; 3], [1.0, 1.0, -1.0]]);
        assert_eq!(handedness(&nodes, &[flip]), [mirrors, either, either, either]);
        let twice = scaling(1, [[-1.0, -1.0, 1.0]; 2]);
        // The rest pose counts, too: between (1, 1, 1) and (-1, -1, 1), either sign may occur.
        assert_eq!(handedness(&nodes, &[twice])[1], either);
    }

    #[test]
    fn children_of_moving_nodes_count_as_moving() {
        let nodes = [node(None, Vec3::ONE), node(None, Vec3::ONE), node(Some(1), Vec3::ONE)];
        assert_eq!(moving(&nodes, &[scaling(1, [[1.0; 3]; 2])]), [false, true, true]);
    }

    #[test]
    fn times_are_clamped_to_the_animation_range() {
        let nodes = [node(None, Vec3::ONE)];
        let animation = scaling(0, [[1.0; 3], [3.0; 3]]);
        for (time_s, scale) in [(-5.0, 1.0), (0.5, 2.0), (1.0, 3.0), (f32::INFINITY, 3.0)] {
            let mut pose = Pose::rest(&nodes);
            pose.play(&animation, time_s);
            let matrix = pose.file_from_node(&nodes).unwrap()[0];
            assert_eq!(matrix.x_axis.x, scale, "at {time_s} s");
            assert_eq!(matrix.w_axis.x, 1.0);
        }
    }

    #[test]
    fn overflow_names_the_node() {
        let huge = Vec3::splat(1e30);
        let nodes = [node(None, huge), node(Some(0), huge)];
        assert_eq!(Pose::rest(&nodes).file_from_node(&nodes), Err(1));
    }
}
