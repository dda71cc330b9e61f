//! Meshes from a program's arrays.

use glam::{Vec2, Vec3};

use super::normals;
use crate::Mesh;

impl Mesh {
    /// A mesh from positions in metres and vertex indices, three per triangle, counter-clockwise
    /// seen from its front. [`Scene::validate`](crate::Scene::validate) checks the mesh as part of
    /// a scene.
    ///
    /// Without `normals`, edges with an angle below `crease_rad` (0 to pi) become smooth; vertices
    /// at other edges are duplicated. Given normals of length zero are replaced by their triangles'
    /// normals. Without `uvs` all texture coordinates are zero.
    ///
    /// If a vertex index is beyond the last position, or the last triangle is incomplete, no
    /// normals are computed; `validate` then refuses the mesh.
    pub fn from_arrays(
        name: &str,
        positions: Vec<Vec3>,
        indices: Vec<u32>,
        normals: Option<Vec<Vec3>>,
        uvs: Option<Vec<Vec2>>,
        crease_rad: f32,
    ) -> Self {
        let uvs = uvs.unwrap_or_else(|| vec![Vec2::ZERO; positions.len()]);
        let mut mesh = Self { name: name.to_owned(), positions, indices, uvs, ..Self::default() };
        let is_sound = mesh.uvs.len() == mesh.positions.len()
            && mesh.indices.len().is_multiple_of(3)
            && mesh.indices.iter().all(|&index| (index as usize) < mesh.positions.len());
        match normals {
            Some(normals) => {
                mesh.normals = normals;
                if is_sound && mesh.normals.len() == mesh.positions.len() {
                    normals::repair(&mut mesh.normals, &mesh.positions, &mesh.indices);
                }
            }
            None if is_sound => {
                let corners = normals::creased(&mesh.positions, &mesh.indices, crease_rad);
                normals::set_corner_normals(&mut mesh, &corners);
            }
            None => mesh.normals = vec![Vec3::Y; mesh.positions.len()],
        }
        normals::set_any_tangents(&mut mesh);
        mesh
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Instance, Material, Scene};

    fn scene(mesh: Mesh) -> Scene {
        Scene {
            name: "arrays".to_owned(),
            meshes: vec![mesh],
            instances: vec![Instance::default()],
            materials: vec![Material::default()],
            ..Scene::default()
        }
    }

    /// Two triangles that share an edge at a right angle.
    fn roof() -> (Vec<Vec3>, Vec<u32>) {
        (vec![Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::Z], vec![0, 1, 2, 1, 0, 3])
    }

    #[test]
    fn edges_are_sharp_or_smooth_by_their_angle() {
        let (positions, indices) = roof();
        for (crease_rad, vertices) in [(1.0, 6), (3.0, 4)] {
            let mesh =
                Mesh::from_arrays("a", positions.clone(), indices.clone(), None, None, crease_rad);
            assert_eq!(mesh.positions.len(), vertices);
            scene(mesh).validate().unwrap();
        }
    }

    #[test]
    fn given_normals_are_kept_and_repaired() {
        let (positions, indices) = roof();
        let normals = vec![Vec3::new(0.0, 2.0, 0.0), Vec3::ZERO, Vec3::Z, Vec3::Y];
        let mesh = Mesh::from_arrays("a", positions, indices, Some(normals), None, 0.0);
        assert_eq!((mesh.normals[0], mesh.normals[2]), (Vec3::Y, Vec3::Z));
        assert!((mesh.normals[1].length() - 1.0).abs() < 1e-6);
        scene(mesh).validate().unwrap();
    }

    #[test]
    fn broken_arrays_are_refused() {
        let (positions, indices) = roof();
        let made = |positions: &[Vec3], indices: &[u32], normals: Option<Vec<Vec3>>| {
            let (positions, indices) = (positions.to_vec(), indices.to_vec());
            scene(Mesh::from_arrays("a", positions, indices, normals, None, 1.0)).validate()
        };
        assert!(made(&positions, &[0, 1, 9], None).is_err());
        assert!(made(&positions, &indices[..4], None).is_err());
        assert!(made(&positions, &indices, Some(vec![Vec3::Y])).is_err());
        assert!(made(&[Vec3::NAN; 4], &indices, None).is_err());
    }
}
