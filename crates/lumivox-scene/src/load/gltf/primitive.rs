//! One glTF primitive becomes one mesh: a list of triangles with all attributes filled.

use glam::{Vec2, Vec3, Vec4};
use gltf::Semantic;
use gltf::mesh::Mode;

use super::{Loader, name_or_index, own_vertices, tangents};
use crate::load::normals::{self, unit_or_zero};
use crate::load::repair;
use crate::{Mesh, SceneError};

impl Loader<'_> {
    /// Loads a primitive once per winding. `None` if it has no triangles.
    pub(super) fn primitive(
        &mut self,
        mesh: &gltf::Mesh<'_>,
        primitive: &gltf::Primitive<'_>,
        mirrored: bool,
        material: usize,
    ) -> Result<Option<usize>, SceneError> {
        let name = mesh_name(mesh, primitive);
        let key = self.mesh_key(&name, primitive, mirrored, material);
        if let Some(&known) = self.meshes.get(&key) {
            return Ok(known);
        }
        let loaded = self.read(primitive, name, material)?.map(|mut mesh| {
            if mirrored {
                mesh.flip_winding();
            }
            self.scene.meshes.push(mesh);
            self.scene.meshes.len() - 1
        });
        self.meshes.insert(key, loaded);
        Ok(loaded)
    }

    /// Reads a primitive's triangles, in the file's order.
    pub(super) fn read(
        &mut self,
        primitive: &gltf::Primitive<'_>,
        name: String,
        material: usize,
    ) -> Result<Option<Mesh>, SceneError> {
        let part = format!("mesh \"{name}\"");
        let mode = primitive.mode();
        if !matches!(mode, Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan) {
            self.notes.warn(format!("{part}: points and lines are not shown and were skipped"));
            return Ok(None);
        }
        let accessor = |semantic: Semantic| primitive.get(&semantic).map(|a| a.index());
        let Some(positions) = accessor(Semantic::Positions) else {
            self.notes.warn(format!("{part}: it has no positions and was skipped"));
            return Ok(None);
        };
        self.spend_geometry(&part, primitive)?;

        let positions = self.read_floats::<3>(positions, "positions")?;
        let positions: Vec<Vec3> = positions.into_iter().map(Vec3::from_array).collect();
        let count = positions.len();
        let indices = match primitive.indices() {
            Some(indices) => {
                let indices = self.read_indices(indices.index())?;
                self.check_indices(&part, &indices, count)?;
                indices
            }
            None => (0..count as u32).collect(),
        };
        let surplus = indices.len() % 3;
        if mode == Mode::Triangles && surplus != 0 {
            self.notes.warn(format!(
                "{part}: its {} indices make no whole number of triangles; the last {surplus} were \
                 ignored",
                indices.len()
            ));
        }
        let indices = to_triangles(mode, &indices);

        let uvs = match accessor(Semantic::TexCoords(0)) {
            Some(uvs) => self.read_uvs(uvs)?,
            None => vec![Vec2::ZERO; count],
        };
        let uvs1 = self.read_second_uvs(primitive, &part, material)?;
        let colors = match accessor(Semantic::Colors(0)) {
            Some(colors) => self.read_colors(colors)?,
            None => Vec::new(),
        };
        let normals = match accessor(Semantic::Normals) {
            Some(normals) => Some(self.read_floats::<3>(normals, "normals")?),
            None => None,
        };
        // Tangents without normals must be ignored (glTF 2.0, section 3.7.2.1).
        let mut tangents = match accessor(Semantic::Tangents) {
            Some(tangents) if normals.is_some() => {
                Some(self.read_floats::<4>(tangents, "tangents")?)
            }
            _ => None,
        };
        let lengths = [
            Some(uvs.len()),
            normals.as_ref().map(Vec::len),
            tangents.as_ref().map(Vec::len),
            Some(uvs1.len()).filter(|_| !uvs1.is_empty()),
            Some(colors.len()).filter(|_| !colors.is_empty()),
        ];
        if lengths.into_iter().flatten().any(|length| length != count) {
            return Err(self.malformed(&part, "its attributes differ in length"));
        }

        let mut mesh = Mesh {
            name,
            positions,
            normals: Vec::new(),
            uvs,
            uvs1,
            colors,
            tangents: Vec::new(),
            indices,
        };
        repair::attributes(&mut mesh, &mut self.notes);
        if mesh.colors.iter().all(|&color| color == Vec4::ONE) {
            mesh.colors = Vec::new();
        }
        match normals {
            Some(normals) => {
                mesh.normals = normals.into_iter().map(Vec3::from_array).collect();
                own_vertices::keep_own(&mut mesh, tangents.as_mut());
                repair::directions(&mut mesh, &mut self.notes);
            }
            None => make_flat(&mut mesh),
        }
        normals::set_any_tangents(&mut mesh);
        match (tangents, self.scene.materials[material].normal_texture) {
            (Some(given), _) => use_tangents(&mut mesh, &given),
            (None, Some(texture)) => tangents::generate_for(&mut mesh, texture),
            (None, _) => {}
        }
        Ok(Some(mesh))
    }

    fn check_indices(
        &self,
        part: &str,
        indices: &[u32],
        vertices: usize,
    ) -> Result<(), SceneError> {
        match indices.iter().position(|&index| index as usize >= vertices) {
            None => Ok(()),
            Some(i) => Err(SceneError::IndexOutOfRange {
                file: self.file.to_owned(),
                part: format!("{part}, index {i}"),
                index: indices[i] as usize,
                count: vertices,
                target: "vertices",
            }),
        }
    }
}

/// The name of a primitive in messages.
pub(super) fn mesh_name(mesh: &gltf::Mesh<'_>, primitive: &gltf::Primitive<'_>) -> String {
    let name = name_or_index(mesh.name(), "mesh", mesh.index());
    if mesh.primitives().len() > 1 {
        return format!("{name}, primitive {}", primitive.index());
    }
    name
}

/// Converts a list, strip or fan to a list of triangles (glTF 2.0, section 3.7.2.1). Surplus
/// vertices are dropped.
pub(super) fn to_triangles(mode: Mode, indices: &[u32]) -> Vec<u32> {
    match mode {
        Mode::TriangleStrip => indices
            .windows(3)
            .enumerate()
            // Every second triangle of a strip has the opposite winding.
            .flat_map(|(i, t)| if i % 2 == 0 { [t[0], t[1], t[2]] } else { [t[0], t[2], t[1]] })
            .collect(),
        Mode::TriangleFan => match indices {
            [hub, rim @ ..] => rim.windows(2).flat_map(|edge| [edge[0], edge[1], *hub]).collect(),
            [] => Vec::new(),
        },
        _ => indices[..indices.len() / 3 * 3].to_vec(),
    }
}

/// Gives every triangle its own vertices and the normal of its plane, as glTF prescribes for files
/// without normals.
fn make_flat(mesh: &mut Mesh) {
    let corners = mesh.indices.iter().map(|&i| i as usize);
    mesh.uvs = corners.clone().map(|i| mesh.uvs[i]).collect();
    if !mesh.uvs1.is_empty() {
        mesh.uvs1 = corners.clone().map(|i| mesh.uvs1[i]).collect();
    }
    if !mesh.colors.is_empty() {
        mesh.colors = corners.clone().map(|i| mesh.colors[i]).collect();
    }
    mesh.positions = corners.map(|i| mesh.positions[i]).collect();
    mesh.indices = (0..mesh.positions.len() as u32).collect();
    mesh.normals = normals::flat(&mesh.positions);
}

/// Uses the file's tangents that have a direction.
fn use_tangents(mesh: &mut Mesh, given: &[[f32; 4]]) {
    for (tangent, given) in mesh.tangents.iter_mut().zip(given) {
        let given = Vec4::from_array(*given);
        let direction = unit_or_zero(given.truncate());
        if given.is_finite() && direction != Vec3::ZERO {
            *tangent = direction.extend(if given.w < 0.0 { -1.0 } else { 1.0 });
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn strips_and_fans_become_consistently_wound_triangles() {
        let strip = to_triangles(Mode::TriangleStrip, &[0, 1, 2, 3, 4]);
        assert_eq!(strip, [0, 1, 2, 1, 3, 2, 2, 3, 4]);
        let fan = to_triangles(Mode::TriangleFan, &[0, 1, 2, 3]);
        assert_eq!(fan, [1, 2, 0, 2, 3, 0]);
        assert_eq!(to_triangles(Mode::Triangles, &[0, 1, 2, 3]), [0, 1, 2]);
        for mode in [Mode::Triangles, Mode::TriangleStrip, Mode::TriangleFan] {
            for indices in [&[][..], &[0], &[0, 1]] {
                assert!(to_triangles(mode, indices).is_empty());
            }
        }
    }
}
