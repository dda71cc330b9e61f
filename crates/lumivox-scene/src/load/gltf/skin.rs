//! Skins: lists of joints, and the pose in which the mesh was bound to them.

use glam::Mat4;

use super::node::Tree;
use super::{Loader, name_or_index};
use crate::SceneError;
use crate::load::repair;
use crate::pose::Skin;

impl Loader<'_> {
    /// Loads a skin once, and returns its index in the rig.
    pub(super) fn skin(&mut self, skin: &gltf::Skin<'_>, tree: &Tree) -> Result<usize, SceneError> {
        if let Some(&known) = self.skins.get(&skin.index()) {
            return Ok(known);
        }
        let part = name_or_index(skin.name(), "skin", skin.index());
        let joints: Option<Vec<usize>> =
            skin.joints().map(|joint| tree.place(joint.index())).collect();
        let Some(joints) = joints else {
            return Err(self.malformed(&part, "a joint is in no tree of nodes"));
        };
        if joints.is_empty() {
            return Err(self.malformed(&part, "it has no joints"));
        }
        let mut joint_from_mesh = match skin.inverse_bind_matrices() {
            None => vec![Mat4::IDENTITY; joints.len()],
            Some(accessor) => {
                let matrices = self.read_floats::<16>(accessor.index(), "inverse bind matrices")?;
                if matrices.len() < joints.len() {
                    let reason = format!(
                        "it has {} inverse bind matrices for {} joints",
                        matrices.len(),
                        joints.len()
                    );
                    return Err(self.malformed(&part, &reason));
                }
                matrices.iter().take(joints.len()).map(Mat4::from_cols_array).collect()
            }
        };
        let broken = repair::replace(joint_from_mesh.iter_mut(), |m| m.is_finite(), Mat4::IDENTITY);
        if broken > 0 {
            self.notes.warn(format!(
                "{part}: {broken} inverse bind matrices are not finite and became the identity"
            ));
        }
        self.rig.skins.push(Skin { joints, joint_from_mesh });
        let index = self.rig.skins.len() - 1;
        self.skins.insert(skin.index(), index);
        Ok(index)
    }
}
