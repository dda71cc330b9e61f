//! Deforms vertices by morph targets, then by bones (glTF 2.0, sections 3.7.2.2 and 3.7.3.3).
//!
//! Each target adds its displacements times its weight. Then each vertex is moved by the weighted
//! mean of its joints' matrices M: positions by M, tangents by M's linear part, normals by the
//! inverse transpose of that. The inverse transpose is the cofactors divided by the determinant, of
//! which only the sign matters for a direction; cofactors also exist for matrices that flatten.
//! Tangents are made orthogonal to their normals again.
//!
//! Meshes whose file has no normals are flat: each triangle has its own three consecutive vertices,
//! and gets the normal of its deformed plane.
//!
//! If M mirrors, the winding of the triangles is reversed, so that front sides stay front sides,
//! and the signs of bitangents, too.

use std::sync::atomic::{AtomicBool, Ordering};

use glam::{Affine3A, DVec3, Mat3A, Vec3, Vec3A, Vec4};
use rayon::prelude::*;

use crate::Mesh;
use crate::model::any_tangent;
use crate::validate::has_area;

/// Vertices in one thread's chunk: a multiple of three, so that flat triangles are not divided. Its
/// 200 kB fit into caches.
const CHUNK: usize = 3 << 10;

/// One of the scene's meshes, and the joints and targets that move its vertices.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Deformed {
    /// Index into the scene's meshes.
    pub(crate) mesh: usize,
    /// The node that has the weights of the targets.
    pub(crate) node: usize,
    /// Index into the rig's skins; `None` without bones.
    pub(crate) skin: Option<usize>,
    pub(crate) base: Base,
    /// One target per weight of the node; targets whose weight is always zero may be empty.
    pub(crate) targets: Vec<Target>,
    /// The influences of joints; empty without a skin.
    pub(crate) influences: Influences,
}

/// The mesh before it is deformed.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Base {
    pub(crate) positions: Vec<Vec3>,
    pub(crate) normals: Vec<Vec3>,
    pub(crate) tangents: Vec<Vec4>,
    pub(crate) indices: Vec<u32>,
    /// `true` if normals are those of the triangles' planes; each triangle then has its own three
    /// vertices.
    pub(crate) is_flat: bool,
}

/// The vertices that a morph target displaces.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Target {
    /// Vertex numbers, ascending.
    pub(crate) vertices: Vec<u32>,
    /// A displacement for each of `vertices`.
    pub(crate) positions: Vec<Vec3>,
    /// One per vertex, or empty.
    pub(crate) normals: Vec<Vec3>,
    /// One per vertex, or empty.
    pub(crate) tangents: Vec<Vec3>,
}

/// The joints that move each vertex, with weights.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Influences {
    /// The number of joints per vertex; unused joints have weight zero.
    pub(crate) per_vertex: usize,
    /// Indices into the skin's joints.
    pub(crate) joints: Vec<u16>,
    /// At least 0; their sum is one for each vertex.
    pub(crate) weights: Vec<f32>,
}

/// A range of vertices of the deformed mesh.
struct Chunk<'a> {
    /// The number of the first vertex.
    first: usize,
    positions: &'a mut [Vec3],
    normals: &'a mut [Vec3],
    tangents: &'a mut [Vec4],
}

impl Deformed {
    /// Writes the deformed vertices and the triangles that have an area into `mesh`; `false` if a
    /// number overflows. `joints` holds a matrix for each joint of the skin.
    pub(super) fn deform(
        &self,
        weights: &[f32],
        joints: Option<&[Affine3A]>,
        mesh: &mut Mesh,
    ) -> bool {
        let count = self.base.positions.len();
        mesh.positions.resize(count, Vec3::ZERO);
        mesh.normals.resize(count, Vec3::Y);
        mesh.tangents.resize(count, Vec4::ZERO);
        let joints = joints.filter(|joints| !joints.is_empty());
        let (overflow, mirrors) = (AtomicBool::new(false), AtomicBool::new(false));
        let chunks = mesh
            .positions
            .par_chunks_mut(CHUNK)
            .zip(mesh.normals.par_chunks_mut(CHUNK))
            .zip(mesh.tangents.par_chunks_mut(CHUNK))
            .enumerate();
        chunks.for_each(|(i, ((positions, normals), tangents))| {
            let mut chunk = Chunk { first: i * CHUNK, positions, normals, tangents };
            self.morph(weights, &mut chunk);
            if let Some(joints) = joints
                && self.skin(joints, &mut chunk)
            {
                mirrors.store(true, Ordering::Relaxed);
            }
            if chunk.positions.iter().any(|p| !p.is_finite()) {
                overflow.store(true, Ordering::Relaxed);
            }
        });
        if overflow.into_inner() {
            return false;
        }
        mesh.indices.clone_from(&self.base.indices);
        if let Some(joints) = joints
            && mirrors.into_inner()
        {
            self.turn_mirrored(joints, mesh);
        }
        drop_flat(mesh);
        true
    }

    /// Copies a chunk of the base and displaces it.
    fn morph(&self, weights: &[f32], chunk: &mut Chunk<'_>) {
        let (first, end) = (chunk.first, chunk.first + chunk.positions.len());
        chunk.positions.copy_from_slice(&self.base.positions[first..end]);
        chunk.normals.copy_from_slice(&self.base.normals[first..end]);
        chunk.tangents.copy_from_slice(&self.base.tangents[first..end]);
        let mut is_touched = Vec::new();
        for (target, &weight) in self.targets.iter().zip(weights) {
            let begin = target.vertices.partition_point(|&v| (v as usize) < first);
            let stop = target.vertices.partition_point(|&v| (v as usize) < end);
            if weight == 0.0 || begin == stop {
                continue;
            }
            is_touched.resize(chunk.positions.len(), false);
            for entry in begin..stop {
                let vertex = target.vertices[entry] as usize - first;
                is_touched[vertex] = true;
                chunk.positions[vertex] += weight * target.positions[entry];
                if let Some(&normal) = target.normals.get(entry) {
                    chunk.normals[vertex] += weight * normal;
                }
                if let Some(&tangent) = target.tangents.get(entry) {
                    chunk.tangents[vertex] += (weight * tangent).extend(0.0);
                }
            }
        }
        if is_touched.is_empty() {
            return;
        }
        if self.base.is_flat {
            flatten(chunk, |_| false);
            // A corner that moves also changes the normals of the other two.
            is_touched.fill(true);
        }
        for (vertex, _) in is_touched.iter().enumerate().filter(|(_, touched)| **touched) {
            let normal = unit_or(chunk.normals[vertex], self.base.normals[first + vertex]);
            chunk.normals[vertex] = normal;
            chunk.tangents[vertex] = orthogonal(chunk.tangents[vertex], normal);
        }
    }

    /// Moves a chunk by its joints, and returns whether any vertex was mirrored.
    fn skin(&self, joints: &[Affine3A], chunk: &mut Chunk<'_>) -> bool {
        let mut mirrors = false;
        for vertex in 0..chunk.positions.len() {
            let matrix = self.matrix(joints, chunk.first + vertex);
            let linear = matrix.matrix3;
            let (cofactors, determinant) = cofactors(linear);
            mirrors |= determinant < 0.0;
            let sign = if determinant < 0.0 { -1.0 } else { 1.0 };
            let normal = Vec3A::from(chunk.normals[vertex]);
            let turned = Vec3::from(cofactors * normal * sign);
            // A bone of size zero leaves no normal; its triangles have no area.
            let normal = unit_or(turned, chunk.normals[vertex]);
            let tangent = chunk.tangents[vertex];
            let along = Vec3::from(linear * Vec3A::from(tangent.truncate()));
            chunk.positions[vertex] =
                matrix.transform_point3a(chunk.positions[vertex].into()).into();
            chunk.normals[vertex] = normal;
            chunk.tangents[vertex] = orthogonal(along.extend(tangent.w * sign), normal);
        }
        if self.base.is_flat {
            flatten(chunk, |vertex| mirrors && self.mirrors(joints, vertex));
            for (normal, tangent) in chunk.normals.iter().zip(chunk.tangents.iter_mut()) {
                *tangent = orthogonal(*tangent, *normal);
            }
        }
        mirrors
    }

    /// The weighted mean of the matrices of a vertex's joints.
    fn matrix(&self, joints: &[Affine3A], vertex: usize) -> Affine3A {
        let Influences { per_vertex, joints: chosen, weights } = &self.influences;
        let range = vertex * per_vertex..(vertex + 1) * per_vertex;
        let mut sum = Affine3A { matrix3: Mat3A::ZERO, translation: Vec3A::ZERO };
        for (&joint, &weight) in chosen[range.clone()].iter().zip(&weights[range]) {
            let joint = &joints[usize::from(joint)];
            sum.matrix3.x_axis += joint.matrix3.x_axis * weight;
            sum.matrix3.y_axis += joint.matrix3.y_axis * weight;
            sum.matrix3.z_axis += joint.matrix3.z_axis * weight;
            sum.translation += joint.translation * weight;
        }
        sum
    }

    fn mirrors(&self, joints: &[Affine3A], vertex: usize) -> bool {
        cofactors(self.matrix(joints, vertex).matrix3).1 < 0.0
    }

    /// Reverses triangles with at least two mirrored corners.
    fn turn_mirrored(&self, joints: &[Affine3A], mesh: &mut Mesh) {
        mesh.indices.par_chunks_exact_mut(3).for_each(|triangle| {
            let corners = triangle.iter().filter(|&&v| self.mirrors(joints, v as usize)).count();
            if corners >= 2 {
                triangle.swap(1, 2);
            }
        });
    }
}

/// The matrix that transforms normals, up to a factor and the determinant's sign; and the
/// determinant, up to a positive factor.
fn cofactors(m: Mat3A) -> (Mat3A, f32) {
    let plain = |m: Mat3A| {
        let x = m.y_axis.cross(m.z_axis);
        let cofactors = Mat3A::from_cols(x, m.z_axis.cross(m.x_axis), m.x_axis.cross(m.y_axis));
        (cofactors, m.x_axis.dot(x))
    };
    let (cofactors, determinant) = plain(m);
    if determinant.is_normal() {
        return (cofactors, determinant);
    }
    // Products of three numbers overflow or underflow long before their factors do.
    let largest = m.to_cols_array().into_iter().fold(0.0_f32, |largest, x| largest.max(x.abs()));
    if largest.is_normal() { plain(m * largest.recip()) } else { (cofactors, 0.0) }
}

/// Gives every three vertices the normal of their plane, reversed if `is_mirrored` is true for the
/// first vertex's number. Triangles without area keep their normals.
fn flatten(chunk: &mut Chunk<'_>, is_mirrored: impl Fn(usize) -> bool) {
    let corners = chunk.positions.chunks_exact(3).zip(chunk.normals.chunks_exact_mut(3));
    for (i, (positions, normals)) in corners.enumerate() {
        let [a, b, c] = [0, 1, 2].map(|i: usize| positions[i].as_dvec3());
        let Some(normal) = (b - a).cross(c - a).try_normalize() else { continue };
        let sign = if is_mirrored(chunk.first + i * 3) { -1.0 } else { 1.0 };
        normals.fill((normal * sign).as_vec3());
    }
}

/// The vector at unit length; `fallback` if it has no direction.
fn unit_or(v: Vec3, fallback: Vec3) -> Vec3 {
    let squared = v.length_squared();
    if squared > 1e-30 && squared < 1e30 {
        return v / squared.sqrt();
    }
    // In f64, the length of a finite f32 vector cannot overflow or underflow.
    v.as_dvec3().try_normalize().map_or(fallback, DVec3::as_vec3)
}

/// The part of a tangent that is orthogonal to the normal, at unit length (Gram and Schmidt).
fn orthogonal(tangent: Vec4, normal: Vec3) -> Vec4 {
    let given = tangent.truncate();
    let along = given - normal * normal.dot(given);
    let squared = along.length_squared();
    // If less than a share of 1e-5 of the length is left, rounding decides its direction.
    if squared > 1e-30 && squared < 1e30 && squared > 1e-10 * given.length_squared() {
        return (along / squared.sqrt()).extend(tangent.w);
    }
    let given = unit_or(given, Vec3::ZERO);
    let along = given - normal * normal.dot(given);
    if along.length_squared() > 1e-10 {
        return along.normalize().extend(tangent.w);
    }
    any_tangent(normal).truncate().extend(tangent.w)
}

/// Removes the triangles without area at this time.
fn drop_flat(mesh: &mut Mesh) {
    let positions = &mesh.positions;
    let is_seen = |t: &[u32]| has_area_fast([t[0], t[1], t[2]].map(|i| positions[i as usize]));
    // Most meshes have none: checking on all cores costs less than copying all triangles.
    let blocks = mesh.indices.par_chunks(3 * CHUNK);
    if blocks.all(|block| block.chunks_exact(3).all(is_seen)) {
        return;
    }
    let triangles = mesh.indices.par_chunks_exact(3).filter(|t| is_seen(t));
    mesh.indices = triangles.flat_map_iter(|t| t.iter().copied()).collect();
}

/// As [`has_area`], which is only called if f32 cannot decide.
fn has_area_fast(corners: [Vec3; 3]) -> bool {
    let [a, b, c] = corners;
    let (u, v) = (b - a, c - a);
    let squared = u.cross(v).length_squared();
    // Rounding of edges, products and differences puts each component off by less than 4 * 2^-24
    // times |u||v|, and the cross product by less than 4.2e-7 times it; squared that is 1.8e-13.
    let is_sure = squared > 1e-30 && squared > 1e-12 * u.length_squared() * v.length_squared();
    is_sure || has_area(corners)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_turn_correctly_for_bones_of_any_scale() {
        for size in [1e-30_f32, 1e-14, 1.0, 1e14, 1e30] {
            // Rotated by 90 degrees about z, mirrored along x, doubled along y.
            let m =
                Mat3A::from_cols(Vec3A::NEG_Y * size, Vec3A::NEG_X * (2.0 * size), Vec3A::Z * size);
            let (cofactors, determinant) = cofactors(m);
            assert!(determinant < 0.0, "{size}");
            let turned = unit_or((cofactors * Vec3A::X * -1.0).into(), Vec3::ZERO);
            assert!((turned - Vec3::NEG_Y).length() < 1e-6, "{size}: {turned}");
        }
        assert_eq!(cofactors(Mat3A::ZERO).1, 0.0);
        assert_eq!(cofactors(Mat3A::from_diagonal(Vec3::new(1.0, 1.0, 0.0))).1, 0.0);
    }
}
