//! Many copies of a node's mesh (`EXT_mesh_gpu_instancing`).

use glam::{Mat4, Quat, Vec3};

use super::Loader;
use crate::SceneError;
use crate::load::files::shorten;
use crate::validate::invertible;

const EXTENSION: &str = "EXT_mesh_gpu_instancing";

impl Loader<'_> {
    /// The transforms of the copies on the node; `None` if the mesh is not instanced.
    pub(super) fn read_copies(
        &mut self,
        node: &gltf::Node<'_>,
        name: &str,
    ) -> Result<Option<Vec<Mat4>>, SceneError> {
        let Some(extension) = node.extension_value(EXTENSION) else { return Ok(None) };
        let Some(attributes) = extension.get("attributes").and_then(|a| a.as_object()) else {
            return Err(self.malformed(name, &format!("{EXTENSION} has no attributes")));
        };
        let (mut translations, mut rotations, mut scales) = (None, None, None);
        for (attribute, accessor) in attributes {
            let accessor = accessor.as_u64().and_then(|index| usize::try_from(index).ok());
            let Some(accessor) = accessor.filter(|&i| i < self.root().accessors.len()) else {
                let attribute = shorten(attribute);
                let reason = format!("{EXTENSION}, {attribute}, names no accessor of the file");
                return Err(self.malformed(name, &reason));
            };
            match attribute.as_str() {
                "TRANSLATION" => translations = Some(accessor),
                "ROTATION" => rotations = Some(accessor),
                "SCALE" => scales = Some(accessor),
                other => self.notes.warn(format!(
                    "{name}: {EXTENSION}, {}, is not supported and was ignored",
                    shorten(other)
                )),
            }
        }
        // Checked before reading: the file must have the data of all copies, and the scene may
        // still add that number of instances.
        let given = || [translations, rotations, scales].into_iter().flatten();
        for accessor in given() {
            self.check_room(accessor, "copies")?;
        }
        let counts: Vec<_> =
            given().map(|accessor| self.root().accessors[accessor].count.0).collect();
        let Some(&count) = counts.first() else { return Ok(None) };
        if counts.iter().any(|&other| other != count) {
            let reason = format!("the attributes of {EXTENSION} differ in length");
            return Err(self.malformed(name, &reason));
        }
        if count > self.budget.instances as u64 {
            return Err(self.too_many(name, "instances"));
        }

        let translations =
            translations.map(|a| self.read_floats::<3>(a, "translations")).transpose()?;
        let rotations = rotations.map(|a| self.read_floats::<4>(a, "rotations")).transpose()?;
        let scales = scales.map(|a| self.read_floats::<3>(a, "scales")).transpose()?;
        let mut copies = Vec::with_capacity(count as usize);
        for i in 0..count as usize {
            let rotation = rotations.as_ref().map_or(Quat::IDENTITY, |r| Quat::from_array(r[i]));
            let length = rotation.length();
            let rotation = if length > 0.0 { rotation / length } else { Quat::IDENTITY };
            let matrix = Mat4::from_scale_rotation_translation(
                scales.as_ref().map_or(Vec3::ONE, |s| Vec3::from_array(s[i])),
                rotation,
                translations.as_ref().map_or(Vec3::ZERO, |t| Vec3::from_array(t[i])),
            );
            copies.extend(Some(matrix).filter(Mat4::is_finite).and_then(|m| invertible(m, false)));
        }
        let hidden = count as usize - copies.len();
        if hidden > 0 {
            self.notes.warn(format!(
                "{name}: {hidden} of {count} copies were skipped, because they are scaled to zero or not finite"
            ));
        }
        Ok(Some(copies))
    }
}
