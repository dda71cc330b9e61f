//! Meshes that morph targets or bones deform. Each use of such a primitive becomes a separate mesh.

use glam::Vec3;
use gltf::Semantic;

use super::Loader;
use super::node::Site;
use super::primitive::{mesh_name, to_triangles};
use crate::load::repair;
use crate::pose::{Base, Deformed, Influences, Target};
use crate::{Mesh, SceneError};

impl Loader<'_> {
    /// Loads a primitive that the site's node deforms. `None` if it has no triangles.
    pub(super) fn deformed(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        site: &Site,
        mirrored: bool,
        material: usize,
        skin: Option<usize>,
    ) -> Result<Option<usize>, SceneError> {
        let name = mesh_name(mesh, primitive);
        let part = format!("mesh \"{name}\"");
        let Some(mut read) = self.read(primitive, name, material)? else { return Ok(None) };
        // The mesh is stored twice: as in the file, and deformed.
        let base_bytes = read.positions.len() * (12 + 12 + 16) + read.indices.len() * 4;
        self.spend_bytes(&part, base_bytes as u64)?;
        let sources = self.sources(&part, primitive, &read)?;
        let targets = self.morph_targets(&part, primitive, site, &sources)?;
        let influences = match skin {
            Some(skin) => {
                let joints = self.rig.skins[skin].joints.len();
                self.influences(&part, primitive, &sources, joints)?
            }
            None => Influences::default(),
        };
        if mirrored {
            read.flip_winding();
        }
        let index = self.scene.meshes.len();
        self.rig.deformed.push(Deformed {
            mesh: index,
            node: site.node,
            skin,
            base: Base {
                positions: read.positions.clone(),
                normals: read.normals.clone(),
                tangents: read.tangents.clone(),
                indices: read.indices.clone(),
                is_flat: primitive.get(&Semantic::Normals).is_none(),
            },
            targets,
            influences,
        });
        self.scene.meshes.push(read);
        Ok(Some(index))
    }

    /// Maps the mesh's vertices to the file's. Flat shading and tangents split vertices, but keep
    /// the order of the triangles' corners.
    fn sources(
        &self,
        part: &str,
        primitive: &gltf::Primitive<'_>,
        mesh: &Mesh,
    ) -> Result<Sources, SceneError> {
        let count = primitive
            .get(&Semantic::Positions)
            .map_or(0, |accessor| self.root().accessors[accessor.index()].count.0 as usize);
        let corners = match primitive.indices() {
            Some(indices) => self.read_indices(indices.index())?,
            None => (0..count as u32).collect(),
        };
        let corners = to_triangles(primitive.mode(), &corners);
        if corners.len() != mesh.indices.len() || corners.iter().any(|&c| c as usize >= count) {
            return Err(self.malformed(part, "its triangles cannot be deformed"));
        }
        // Unused vertices may map to any existing vertex.
        let last = (count.max(1) - 1) as u32;
        let mut of: Vec<u32> = (0..mesh.positions.len() as u32).map(|i| i.min(last)).collect();
        // Backwards, so that the first use wins: a dropped triangle repeats its first corner.
        for (&vertex, &corner) in mesh.indices.iter().zip(&corners).rev() {
            of[vertex as usize] = corner;
        }
        Ok(Sources { of, count })
    }

    fn morph_targets(
        &mut self,
        part: &str,
        primitive: &gltf::Primitive<'_>,
        site: &Site,
        sources: &Sources,
    ) -> Result<Vec<Target>, SceneError> {
        let keeps_tangents = primitive.get(&Semantic::Tangents).is_some();
        let is_flat = primitive.get(&Semantic::Normals).is_none();
        let mut targets = Vec::new();
        for (i, given) in primitive.morph_targets().enumerate() {
            let rest = self.rig.nodes[site.node].weights.get(i).copied().unwrap_or(0.0);
            if !site.weighs && rest == 0.0 {
                targets.push(Target::default());
                continue;
            }
            let mut read = |accessor: Option<gltf::Accessor<'_>>, what: &str| match accessor {
                Some(accessor) => {
                    let part = format!("{part}, morph target {i}");
                    self.displacements(&part, what, accessor.index(), sources)
                }
                None => Ok(Vec::new()),
            };
            let positions = read(given.positions(), "positions")?;
            // The normals of flat meshes come from triangles, and their tangents from these
            // normals.
            let normals = read(given.normals().filter(|_| !is_flat), "normals")?;
            let tangents =
                read(given.tangents().filter(|_| keeps_tangents && !is_flat), "tangents")?;
            targets.push(sources.target(&positions, &normals, &tangents));
        }
        Ok(targets)
    }

    fn displacements(
        &mut self,
        part: &str,
        what: &str,
        accessor: usize,
        sources: &Sources,
    ) -> Result<Vec<Vec3>, SceneError> {
        let count = sources.count;
        // A vector and an index for each vertex that moves, which may be all of them.
        self.spend_bytes(part, sources.of.len() as u64 * 16)?;
        let values = self.read_floats::<3>(accessor, &format!("morphed {what}"))?;
        if values.len() != count {
            let reason = format!("it has {} {what} for {count} vertices", values.len());
            return Err(self.malformed(part, &reason));
        }
        let mut values: Vec<Vec3> = values.into_iter().map(Vec3::from_array).collect();
        let broken = repair::replace(values.iter_mut(), Vec3::is_finite, Vec3::ZERO);
        if broken > 0 {
            self.notes.warn(format!("{part}: {broken} {what} are not finite and became zero"));
        }
        Ok(values)
    }

    /// The joints that move each vertex. Common faults of exporters in weights are repaired.
    fn influences(
        &mut self,
        part: &str,
        primitive: &gltf::Primitive<'_>,
        sources: &Sources,
        joints: usize,
    ) -> Result<Influences, SceneError> {
        let sets = (0..).map_while(|set| {
            let joints = primitive.get(&Semantic::Joints(set))?;
            Some((joints.index(), primitive.get(&Semantic::Weights(set)).map(|w| w.index())))
        });
        let mut sets: Vec<_> = sets.take(MOST_SETS + 1).collect();
        if sets.len() > MOST_SETS {
            sets.truncate(MOST_SETS);
            self.notes.warn(format!(
                "{part}: vertices follow {} joints at most, others were ignored",
                MOST_SETS * 4
            ));
        }
        // A joint of two bytes and a weight of four, for the file's vertices and for the mesh's.
        let numbers = (sources.of.len() + sources.count) as u64 * sets.len() as u64 * 4;
        self.spend_bytes(part, numbers * 6)?;
        let mut bones = Bones::new(sources.count, sets.len() * 4);
        for (joint_accessor, weights) in sets {
            let Some(weights) = weights else {
                return Err(self.malformed(part, "it has joints without weights"));
            };
            let chosen = self.read_floats::<4>(joint_accessor, "joints")?;
            let weights = self.read_floats::<4>(weights, "weights")?;
            if chosen.len() != sources.count || weights.len() != sources.count {
                return Err(self.malformed(part, "its attributes differ in length"));
            }
            let pairs = chosen.as_flattened().iter().zip(weights.as_flattened());
            for (i, (&joint, &weight)) in pairs.enumerate() {
                let vertex = i / 4;
                // A joint with weight zero may have any index.
                if weight == 0.0 {
                    continue;
                }
                if !(joint >= 0.0 && joint.fract() == 0.0 && joint < joints as f32) {
                    return Err(SceneError::IndexOutOfRange {
                        file: self.file.to_owned(),
                        part: format!("{part}, a joint of vertex {vertex},"),
                        index: joint as usize,
                        count: joints,
                        target: "joints in its skin",
                    });
                }
                bones.add(vertex, joint as u16, weight);
            }
        }
        let repaired = (0..sources.count).filter(|&vertex| bones.repair(vertex)).count();
        if repaired > 0 {
            self.notes.warn(format!(
                "{part}: {repaired} vertices have joint weights that are negative or not finite, or \
                 whose sum is not one; they were repaired"
            ));
        }
        Ok(sources.influences(&bones))
    }
}

/// The most sets of four joints that are read.
const MOST_SETS: usize = 4;

/// The joints of the file's vertices, and the number of joints of each.
struct Bones {
    most: usize,
    counts: Vec<u8>,
    joints: Vec<u16>,
    weights: Vec<f32>,
}

impl Bones {
    fn new(vertices: usize, most: usize) -> Self {
        Self {
            most,
            counts: vec![0; vertices],
            joints: vec![0; vertices * most],
            weights: vec![0.0; vertices * most],
        }
    }

    fn add(&mut self, vertex: usize, joint: u16, weight: f32) {
        let at = vertex * self.most + usize::from(self.counts[vertex]);
        self.joints[at] = joint;
        self.weights[at] = weight;
        self.counts[vertex] += 1;
    }

    /// Scales a vertex's weights to a sum of one. Returns `true` if the error was larger than
    /// rounding to eight bits.
    fn repair(&mut self, vertex: usize) -> bool {
        let begin = vertex * self.most;
        let count = usize::from(self.counts[vertex]);
        let weights = &mut self.weights[begin..begin + count];
        let mut has_other = false;
        let mut sum = 0.0;
        for weight in weights.iter_mut() {
            if !(weight.is_finite() && *weight >= 0.0) {
                *weight = 0.0;
                has_other = true;
            }
            sum += f64::from(*weight);
        }
        if sum <= 0.0 {
            // Most tools attach vertices without weights to the first joint.
            weights.fill(0.0);
            self.counts[vertex] = 0;
            self.add(vertex, 0, 1.0);
            return true;
        }
        for weight in weights {
            *weight = (f64::from(*weight) / sum) as f32;
        }
        // The rounding error of each weight is at most half a 255th.
        has_other || (sum - 1.0).abs() > 0.5 / 255.0 * count as f64 + 1e-3
    }
}

/// The file's vertex of each vertex of a mesh.
struct Sources {
    of: Vec<u32>,
    /// The number of the file's vertices.
    count: usize,
}

impl Sources {
    /// Makes a target of the vertices that move. Lists are empty or have one entry per vertex of
    /// the file.
    fn target(&self, positions: &[Vec3], normals: &[Vec3], tangents: &[Vec3]) -> Target {
        let at = |list: &[Vec3], i: u32| list.get(i as usize).copied().unwrap_or(Vec3::ZERO);
        let moves = |i: u32| {
            [positions, normals, tangents].into_iter().any(|list| at(list, i) != Vec3::ZERO)
        };
        let vertices: Vec<u32> =
            (0..self.of.len() as u32).filter(|&v| moves(self.of[v as usize])).collect();
        let pick = |list: &[Vec3]| -> Vec<Vec3> {
            vertices.iter().map(|&v| at(list, self.of[v as usize])).collect()
        };
        let pick_some = |list: &[Vec3]| if list.is_empty() { Vec::new() } else { pick(list) };
        Target {
            positions: pick(positions),
            normals: pick_some(normals),
            tangents: pick_some(tangents),
            vertices,
        }
    }

    fn influences(&self, bones: &Bones) -> Influences {
        let per_vertex = usize::from(bones.counts.iter().copied().max().unwrap_or(0));
        let begins = || self.of.iter().map(|&vertex| vertex as usize * bones.most);
        Influences {
            per_vertex,
            joints: begins().flat_map(|i| &bones.joints[i..i + per_vertex]).copied().collect(),
            weights: begins().flat_map(|i| &bones.weights[i..i + per_vertex]).copied().collect(),
        }
    }
}
