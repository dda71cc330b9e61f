//! Places meshes on nodes: one mesh can be on many nodes, mirrored or not, many times on one node,
//! or deformed differently by each.

use glam::Mat4;
use gltf::Semantic;

use super::Loader;
use super::extras::Marks;
use super::node::{Site, Tree};
use crate::SceneError;
use crate::pose::Placed;
use crate::validate::invertible;

impl Loader<'_> {
    pub(super) fn put_mesh(
        &mut self,
        node: &gltf::Node<'_>,
        mesh: &gltf::Mesh<'_>,
        site: &Site,
        tree: &Tree,
    ) -> Result<(), SceneError> {
        let copies = self.read_copies(node, &site.name)?;
        let is_skinned = |primitive: &gltf::Primitive<'_>| {
            node.skin().is_some() && primitive.get(&Semantic::Joints(0)).is_some()
        };
        // Joints place the vertices that they move, even if the node is scaled to zero.
        let is_nothing = !site.moves && invertible(site.world_from_node, false).is_none();
        if is_nothing && !mesh.primitives().any(|primitive| is_skinned(&primitive)) {
            self.notes
                .warn(format!("{}: its mesh was skipped, because it is scaled to zero", site.name));
            return Ok(());
        }
        let marks = Marks::of(node.extras());
        // A skinned mesh does not move with its node.
        let follows = site.moves && node.skin().is_none();
        if marks.is_static == Some(true) && (follows || site.weighs || site.bends) {
            self.notes.warn(format!(
                "{}: it is marked as static, but an animation moves it: the mark was ignored",
                site.name
            ));
        }
        for primitive in mesh.primitives() {
            // Counted before the test for visibility, because hidden primitives take time, too.
            self.spend_instances(&site.name, 1)?;
            match node.skin() {
                Some(skin) if is_skinned(&primitive) => {
                    if copies.is_some() {
                        self.notes.warn(format!(
                            "{}: it has bones and copies (EXT_mesh_gpu_instancing), which do not \
                             go together: the copies were ignored",
                            site.name
                        ));
                    }
                    let skin = self.skin(&skin, tree)?;
                    self.put_skinned(mesh, &primitive, site, (skin, marks))?;
                }
                skin => {
                    if skin.is_some() {
                        self.notes.warn(format!(
                            "{}: its mesh has no joints for its skin, bones do not move it",
                            site.name
                        ));
                    }
                    self.put_copies(mesh, &primitive, site, (copies.as_deref(), marks))?;
                }
            }
        }
        Ok(())
    }

    /// Adds a skinned mesh, which only its joints place (glTF 2.0, section 3.7.3.3).
    fn put_skinned(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        site: &Site,
        (skin, marks): (usize, Marks),
    ) -> Result<(), SceneError> {
        let material = self.material(primitive)?;
        if let Some(mesh) = self.deformed(mesh, primitive, site, false, material, Some(skin))? {
            self.rig.instances.push(Placed {
                name: site.name.clone(),
                node: None,
                node_from_local: None,
                meshes: [Some(mesh), None],
                material,
                is_static: !site.bends && !site.weighs && marks.is_static != Some(false),
                is_voxelized: !marks.is_kept_out_of_voxels,
                is_hidden: site.is_hidden,
                is_backdrop: marks.is_backdrop,
            });
        }
        Ok(())
    }

    fn put_copies(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        site: &Site,
        (copies, marks): (Option<&[Mat4]>, Marks),
    ) -> Result<(), SceneError> {
        let material = self.material(primitive)?;
        let rest = &self.rig.nodes[site.node].weights;
        let is_morphed = primitive.morph_targets().len() > 0
            && (site.weighs || rest.iter().any(|&weight| weight != 0.0));
        // The mesh without and with reversed winding, loaded when first needed.
        let mut sides: [Option<Option<usize>>; 2] = [None; 2];
        let one = [None];
        let many: Vec<Option<Mat4>>;
        let places = match copies {
            None => &one[..],
            Some(copies) => {
                self.spend_instances(&site.name, copies.len())?;
                many = copies.iter().copied().map(Some).collect();
                &many[..]
            }
        };
        for &node_from_local in places {
            let flips = node_from_local.is_some_and(|m| m.as_dmat4().determinant() < 0.0);
            let mut meshes = [None; 2];
            for mirrored in [false, true] {
                if !site.handedness[usize::from(mirrored != flips)] {
                    continue;
                }
                let side = usize::from(mirrored);
                meshes[side] = match sides[side] {
                    Some(known) => known,
                    None if is_morphed => {
                        self.deformed(mesh, primitive, site, mirrored, material, None)?
                    }
                    None => self.primitive(mesh, primitive, mirrored, material)?,
                };
                sides[side] = Some(meshes[side]);
            }
            if meshes != [None; 2] {
                self.rig.instances.push(Placed {
                    name: site.name.clone(),
                    node: Some(site.node),
                    node_from_local,
                    meshes,
                    material,
                    is_static: !site.moves && !site.weighs && marks.is_static != Some(false),
                    is_voxelized: !marks.is_kept_out_of_voxels,
                    is_hidden: site.is_hidden,
                    is_backdrop: marks.is_backdrop,
                });
            }
        }
        Ok(())
    }

    fn spend_instances(&mut self, part: &str, count: usize) -> Result<(), SceneError> {
        let left = self.budget.instances.checked_sub(count);
        self.budget.instances = left.ok_or_else(|| self.too_many(part, "instances"))?;
        Ok(())
    }
}
