//! Normals for meshes that have none, or broken ones.
//!
//! A smooth normal is the mean over the corners that share it, weighted by their angles (Thürmer
//! and Wüthrich 1998, "Computing vertex normals from polygonal facets"), so it does not depend on
//! how a surface is divided into triangles.

use glam::{DVec3, Vec3};

use crate::Mesh;
use crate::model::{any_tangent, to_unit};

/// The unit normal of a triangle; zero if it has no area.
pub(super) fn face_normal([a, b, c]: [Vec3; 3]) -> Vec3 {
    let [a, b, c] = [a, b, c].map(Vec3::as_dvec3);
    (b - a).cross(c - a).normalize_or_zero().as_vec3()
}

/// The vector at unit length; zero if it has no direction.
pub(super) fn unit_or_zero(v: Vec3) -> Vec3 {
    to_unit(v).unwrap_or(Vec3::ZERO)
}

/// The contribution of each corner of a triangle to its vertex's normal; zero where the triangle
/// has no area.
pub(super) fn corner_normals(corners: [Vec3; 3]) -> [Vec3; 3] {
    let normal = face_normal(corners);
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let sides = [b - a, c - b, a - c].map(DVec3::normalize_or_zero);
    // The angle between the sides before and after a corner is its outer angle.
    let angle = |before: DVec3, after: DVec3| (-before).dot(after).clamp(-1.0, 1.0).acos();
    [(sides[2], sides[0]), (sides[0], sides[1]), (sides[1], sides[2])]
        .map(|(before, after)| normal * angle(before, after) as f32)
}

/// The normals of triangles that share no vertices, three positions each.
pub(super) fn flat(corners: &[Vec3]) -> Vec<Vec3> {
    let mut normals = Vec::with_capacity(corners.len());
    for triangle in corners.chunks_exact(3) {
        // Triangles without a direction have no area and are removed later.
        let normal = face_normal([triangle[0], triangle[1], triangle[2]]);
        normals.extend([if normal == Vec3::ZERO { Vec3::Y } else { normal }; 3]);
    }
    normals
}

/// One normal per vertex, from all triangles around it.
pub(super) fn smooth(positions: &[Vec3], indices: &[u32]) -> Vec<Vec3> {
    let mut normals = vec![Vec3::ZERO; positions.len()];
    for triangle in indices.chunks_exact(3) {
        let corners = [0, 1, 2].map(|i| triangle[i] as usize);
        for (i, normal) in corners.into_iter().zip(corner_normals(corners.map(|i| positions[i]))) {
            normals[i] += normal;
        }
    }
    // Vertices that no triangle uses, and those whose normals cancel, may face anywhere.
    for normal in &mut normals {
        *normal = normal.normalize_or(Vec3::Y);
    }
    normals
}

/// One normal per corner: smooth across edges at which exactly two triangles meet at less than
/// `crease_rad`, so that sharper edges stay sharp. Corners at the same point must have the same
/// index in `indices`.
pub(super) fn creased(positions: &[Vec3], indices: &[u32], crease_rad: f32) -> Vec<Vec3> {
    let cosine = crease_rad.cos();
    let faces = |corner: u32| {
        let first = corner as usize / 3 * 3;
        [0, 1, 2].map(|i| positions[indices[first + i] as usize])
    };
    // The corners at each vertex, sorted by counting.
    let mut starts = vec![0_u32; positions.len() + 1];
    for &index in indices {
        starts[index as usize] += 1;
    }
    let mut sum = 0;
    for start in &mut starts {
        sum += *start;
        *start = sum;
    }
    let mut corners = vec![0_u32; indices.len()];
    for (corner, &index) in indices.iter().enumerate().rev() {
        starts[index as usize] -= 1;
        corners[starts[index as usize] as usize] = corner as u32;
    }

    let mut normals = vec![Vec3::ZERO; indices.len()];
    let mut fan = Fan::default();
    for range in starts.windows(2) {
        let around = &corners[range[0] as usize..range[1] as usize];
        fan.clear();
        for (i, &corner) in around.iter().enumerate() {
            let first = corner / 3 * 3;
            let own = corner_normals(faces(corner))[corner as usize % 3];
            fan.sums.push(own);
            fan.faces.push(face_normal(faces(corner)));
            fan.parents.push(i as u32);
            for step in 1..3 {
                let other = indices[(first + (corner - first + step) % 3) as usize];
                fan.edges.push((other, i as u32));
            }
        }
        fan.join(cosine);
        for (i, &corner) in around.iter().enumerate() {
            let root = fan.root(i as u32) as usize;
            let normal = fan.sums[root].normalize_or(fan.faces[i]);
            normals[corner as usize] = normal.normalize_or(Vec3::Y);
        }
    }
    normals
}

/// The triangles around one vertex, as disjoint sets (union-find) of smoothly joined triangles.
#[derive(Default)]
struct Fan {
    sums: Vec<Vec3>,
    faces: Vec<Vec3>,
    parents: Vec<u32>,
    /// (The vertex at the other end, the triangle).
    edges: Vec<(u32, u32)>,
}

impl Fan {
    fn clear(&mut self) {
        self.sums.clear();
        self.faces.clear();
        self.parents.clear();
        self.edges.clear();
    }

    fn root(&mut self, mut i: u32) -> u32 {
        while self.parents[i as usize] != i {
            let above = self.parents[self.parents[i as usize] as usize];
            self.parents[i as usize] = above;
            i = above;
        }
        i
    }

    fn join(&mut self, cosine: f32) {
        let mut edges = std::mem::take(&mut self.edges);
        edges.sort_unstable();
        for pair in edges.chunk_by(|a, b| a.0 == b.0) {
            let &[(_, a), (_, b)] = pair else { continue };
            if self.faces[a as usize].dot(self.faces[b as usize]) < cosine {
                continue;
            }
            let (a, b) = (self.root(a), self.root(b));
            if a != b {
                self.parents[b as usize] = a;
                let sum = self.sums[b as usize];
                self.sums[a as usize] += sum;
            }
        }
        self.edges = edges;
    }
}

/// The most copies of a vertex that are compared before a new one is made: a vertex in thousands of
/// triangles must not take quadratic time.
const LONGEST_CHAIN: usize = 32;

/// Sets one normal per corner, splitting vertices whose corners differ.
pub(super) fn set_corner_normals(mesh: &mut Mesh, normals: &[Vec3]) {
    const NONE: u32 = u32::MAX;
    let mut indices = std::mem::take(&mut mesh.indices);
    let mut next = vec![NONE; mesh.positions.len()];
    let mut taken = vec![false; mesh.positions.len()];
    mesh.normals.resize(mesh.positions.len(), Vec3::Y);
    for (index, &normal) in indices.iter_mut().zip(normals) {
        let first = *index as usize;
        if !std::mem::replace(&mut taken[first], true) {
            mesh.normals[first] = normal;
            continue;
        }
        let mut vertex = first;
        for _ in 0..LONGEST_CHAIN {
            if mesh.normals[vertex] == normal || next[vertex] == NONE {
                break;
            }
            vertex = next[vertex] as usize;
        }
        if mesh.normals[vertex] != normal {
            vertex = copy_vertex(mesh, first);
            mesh.normals.push(normal);
            next.push(next[first]);
            next[first] = vertex as u32;
        }
        *index = vertex as u32;
    }
    mesh.indices = indices;
}

/// Appends a copy of vertex `i` with another normal and tangent.
fn copy_vertex(mesh: &mut Mesh, i: usize) -> usize {
    mesh.positions.push(mesh.positions[i]);
    mesh.uvs.push(mesh.uvs[i]);
    if !mesh.uvs1.is_empty() {
        mesh.uvs1.push(mesh.uvs1[i]);
    }
    if !mesh.colors.is_empty() {
        mesh.colors.push(mesh.colors[i]);
    }
    mesh.positions.len() - 1
}

/// Normalises normals. Normals of length zero, or that are not finite, are replaced by their
/// triangles' normals. Returns how many were replaced.
pub(super) fn repair(normals: &mut [Vec3], positions: &[Vec3], indices: &[u32]) -> usize {
    let mut broken = 0;
    for normal in &mut *normals {
        *normal = if normal.is_finite() { unit_or_zero(*normal) } else { Vec3::ZERO };
        broken += usize::from(*normal == Vec3::ZERO);
    }
    if broken > 0 {
        let smooth = smooth(positions, indices);
        for (normal, smooth) in normals.iter_mut().zip(smooth) {
            if *normal == Vec3::ZERO {
                *normal = smooth;
            }
        }
    }
    broken
}

/// Gives every vertex any tangent orthogonal to its normal.
pub(super) fn set_any_tangents(mesh: &mut Mesh) {
    mesh.tangents = mesh.normals.iter().map(|&normal| any_tangent(normal)).collect();
}

#[cfg(test)]
mod tests {
    use std::f32::consts::{FRAC_PI_2, PI};

    use super::*;

    /// A cube with shared corners; its faces are divided along any diagonal.
    fn cube() -> (Vec<Vec3>, Vec<u32>) {
        let positions = (0..8)
            .map(|i| Vec3::new((i & 1) as f32, (i >> 1 & 1) as f32, (i >> 2) as f32))
            .collect();
        let quads =
            [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
        let indices = quads.iter().flat_map(|&[a, b, c, d]| [a, b, c, a, c, d]).collect();
        (positions, indices)
    }

    #[test]
    fn smooth_normals_do_not_depend_on_quad_diagonals() {
        let (positions, indices) = cube();
        for (position, normal) in positions.iter().zip(smooth(&positions, &indices)) {
            let expected = (*position - Vec3::splat(0.5)).normalize();
            assert!((normal - expected).length() < 1e-6, "{normal} {expected}");
        }
    }

    #[test]
    fn corner_normals_are_weighted_by_angle() {
        let corners = [Vec3::ZERO, Vec3::X * 3.0, Vec3::Y * 4.0];
        let normals = corner_normals(corners);
        assert!((normals[0] - Vec3::Z * FRAC_PI_2).length() < 1e-6);
        assert!((normals.iter().sum::<Vec3>() - Vec3::Z * PI).length() < 1e-5);
        assert_eq!(corner_normals([Vec3::ONE; 3]), [Vec3::ZERO; 3]);
    }

    #[test]
    fn creases_keep_edges_sharp_and_flatter_ones_smooth() {
        let (positions, indices) = cube();
        let sharp = creased(&positions, &indices, 1.0);
        for (triangle, normals) in indices.chunks_exact(3).zip(sharp.chunks_exact(3)) {
            let face = face_normal([0, 1, 2].map(|i| positions[triangle[i] as usize]));
            assert!(normals.iter().all(|n| (*n - face).length() < 1e-6));
        }
        let all = smooth(&positions, &indices);
        for (&index, normal) in indices.iter().zip(creased(&positions, &indices, 3.0)) {
            assert!((normal - all[index as usize]).length() < 1e-6);
        }
    }

    #[test]
    fn vertices_are_split_only_where_corners_differ() {
        let (positions, indices) = cube();
        let uvs = vec![glam::Vec2::ZERO; 8];
        let colors = vec![glam::Vec4::ONE; 8];
        let cube = Mesh { positions, uvs, colors, indices, ..Mesh::default() };
        for (crease, vertices) in [(1.0, 24), (3.0, 8)] {
            let mut mesh = cube.clone();
            let normals = creased(&mesh.positions, &mesh.indices, crease);
            set_corner_normals(&mut mesh, &normals);
            set_any_tangents(&mut mesh);
            // Equal sums can differ by rounding, which only costs vertices.
            assert!((vertices..=36).contains(&mesh.positions.len()), "{}", mesh.positions.len());
            for list in [mesh.normals.len(), mesh.uvs.len(), mesh.colors.len(), mesh.tangents.len()]
            {
                assert_eq!(list, mesh.positions.len());
            }
            for (before, after) in cube.triangles().zip(mesh.triangles()) {
                assert_eq!(before.map(|i| cube.positions[i]), after.map(|i| mesh.positions[i]));
            }
        }
    }

    #[test]
    fn broken_normals_are_replaced() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y];
        let mut normals = [Vec3::Z * 1e-30, Vec3::ZERO, Vec3::NAN];
        assert_eq!(repair(&mut normals, &positions, &[0, 1, 2]), 2);
        assert_eq!(normals, [Vec3::Z; 3]);
    }
}
