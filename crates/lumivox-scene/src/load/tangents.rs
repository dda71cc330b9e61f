//! Tangents by `MikkTSpace` (Mikkelsen 2008, "Simulation of wrinkled surfaces revisited"), the
//! algorithm that glTF prescribes for files without tangents (section 3.7.2.1).

use std::collections::HashMap;

use bevy_mikktspace::{Geometry, TangentSpace, generate_tangents};
use glam::{Vec3, Vec4};

use crate::model::any_tangent;
use crate::{Mesh, TextureRef};

/// Replaces the mesh's tangents by those for a normal texture at its first texture coordinates; see
/// [`generate_for`].
#[cfg_attr(not(test), allow(dead_code, reason = "formats with one set of coordinates want it"))]
pub(super) fn generate(mesh: &mut Mesh) {
    generate_for(mesh, TextureRef::new(0));
}

/// Replaces the mesh's tangents by those for this normal texture: they follow the texture's
/// coordinate set and transform. Vertices whose triangles disagree (mirrored images, seams) are
/// split, so the mesh may grow, at most to one vertex per corner.
pub(super) fn generate_for(mesh: &mut Mesh, normals: TextureRef) {
    let mut corners = Corners { tangents: vec![None; mesh.indices.len()], mesh, normals };
    // The error type has no values.
    if generate_tangents(&mut corners).is_err() {
        return;
    }
    let tangents = corners.tangents;
    weld(mesh, &tangents);
}

/// Sets the tangent of every corner; equal corners of a vertex share one vertex.
fn weld(mesh: &mut Mesh, tangents: &[Option<Vec4>]) {
    let mut known: HashMap<(u32, [u32; 4]), u32> = HashMap::new();
    let mut taken = vec![false; mesh.positions.len()];
    for (corner, index) in mesh.indices.iter_mut().enumerate() {
        let vertex = *index as usize;
        let normal = mesh.normals[vertex];
        let tangent = tangents[corner]
            .filter(|t| t.is_finite() && t.truncate().length_squared() > 0.5)
            .unwrap_or_else(|| any_tangent(normal));
        let key = (*index, tangent.to_array().map(f32::to_bits));
        *index = *known.entry(key).or_insert_with(|| {
            if !taken[vertex] {
                taken[vertex] = true;
                mesh.tangents[vertex] = tangent;
                return *index;
            }
            mesh.positions.push(mesh.positions[vertex]);
            mesh.normals.push(normal);
            mesh.uvs.push(mesh.uvs[vertex]);
            if !mesh.uvs1.is_empty() {
                mesh.uvs1.push(mesh.uvs1[vertex]);
            }
            if !mesh.colors.is_empty() {
                mesh.colors.push(mesh.colors[vertex]);
            }
            mesh.tangents.push(tangent);
            (mesh.positions.len() - 1) as u32
        });
    }
}

struct Corners<'a> {
    mesh: &'a Mesh,
    normals: TextureRef,
    tangents: Vec<Option<Vec4>>,
}

impl Corners<'_> {
    fn vertex(&self, face: usize, corner: usize) -> usize {
        self.mesh.indices[face * 3 + corner] as usize
    }
}

impl Geometry for Corners<'_> {
    fn num_faces(&self) -> usize {
        self.mesh.triangle_count()
    }

    fn num_vertices_of_face(&self, _face: usize) -> usize {
        3
    }

    fn position(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.positions[self.vertex(face, corner)].to_array()
    }

    fn normal(&self, face: usize, corner: usize) -> [f32; 3] {
        self.mesh.normals[self.vertex(face, corner)].to_array()
    }

    fn tex_coord(&self, face: usize, corner: usize) -> [f32; 2] {
        let vertex = self.vertex(face, corner);
        let second = self.mesh.uvs1.get(vertex).filter(|_| self.normals.uv_set == 1);
        let uv = second.copied().unwrap_or(self.mesh.uvs[vertex]);
        self.normals.transform.transform_point2(uv).to_array()
    }

    fn set_tangent(&mut self, space: Option<TangentSpace>, face: usize, corner: usize) {
        // MikkTSpace's bitangent follows growing v, which points down the image in glTF, while the
        // normal texture's y points up: hence the sign.
        self.tangents[face * 3 + corner] = space.map(|space| {
            let [x, y, z, w] = space.tangent_encoded();
            Vec3::new(x, y, z).normalize_or_zero().extend(-w)
        });
    }
}

#[cfg(test)]
mod tests {
    use glam::Vec2;

    use super::*;

    /// A square in the xy plane that faces +z, with the image upright or mirrored on it.
    fn square(mirrored: bool) -> Mesh {
        let corners = [Vec2::ZERO, Vec2::X, Vec2::ONE, Vec2::Y];
        Mesh {
            name: "square".to_owned(),
            positions: corners.map(|c| c.extend(0.0)).to_vec(),
            normals: vec![Vec3::Z; 4],
            uvs: corners
                .map(|c| Vec2::new(if mirrored { 1.0 - c.x } else { c.x }, 1.0 - c.y))
                .to_vec(),
            tangents: vec![Vec4::ZERO; 4],
            indices: vec![0, 1, 2, 0, 2, 3],
            ..Mesh::default()
        }
    }

    #[test]
    fn the_tangent_follows_u_and_the_bitangent_the_images_top() {
        for (mirrored, tangent) in [(false, Vec3::X), (true, Vec3::NEG_X)] {
            let mut mesh = square(mirrored);
            generate(&mut mesh);
            assert_eq!(mesh.positions.len(), 4);
            for t in &mesh.tangents {
                assert!((t.truncate() - tangent).length() < 1e-6, "{t}");
                let bitangent = Vec3::Z.cross(t.truncate()) * t.w;
                assert!((bitangent - Vec3::Y).length() < 1e-6, "{bitangent}");
            }
        }
    }

    #[test]
    fn a_vertex_between_mirrored_halves_is_split() {
        // The second triangle's image is mirrored: the shared edge needs two tangents.
        let mut mesh = square(false);
        mesh.uvs[3] = Vec2::new(1.0, 1.0);
        generate(&mut mesh);
        assert_eq!(mesh.positions.len(), mesh.tangents.len());
        assert!(mesh.positions.len() > 4);
        assert!(mesh.indices.iter().all(|&i| (i as usize) < mesh.positions.len()));
    }

    #[test]
    fn without_texture_coordinates_any_tangent_does() {
        let mut mesh = square(false);
        mesh.uvs.fill(Vec2::ZERO);
        generate(&mut mesh);
        for t in &mesh.tangents {
            assert!(t.truncate().dot(Vec3::Z).abs() < 1e-6);
            assert!((t.truncate().length() - 1.0).abs() < 1e-6);
        }
    }
}
