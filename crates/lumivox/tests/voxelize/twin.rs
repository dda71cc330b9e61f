//! The voxelizer in f64, by brute force: every voxel in a triangle's box by separating axes, every piece by
//! clipping. Slow, plain, and independent of the shaders.

use std::collections::BTreeMap;

use glam::{DVec3, UVec3, Vec3};
use lumivox::Grid;

/// A triangle in grid space.
pub type Triangle = [DVec3; 3];

/// World to grid space in f64.
pub fn in_grid(grid: &Grid, triangle: &[Vec3; 3]) -> Triangle {
    let scale = f64::from(grid.voxel_size_m);
    triangle.map(|p| (p.as_dvec3() - grid.origin_in_world.as_dvec3()) / scale)
}

pub fn is_degenerate(t: &Triangle) -> bool {
    !t.iter().all(|p| p.is_finite()) || (t[1] - t[0]).cross(t[2] - t[0]) == DVec3::ZERO
}

/// By how much the triangle and the closed voxel are apart along the best axis (negative: by how much they
/// would have to move to be apart), in voxels.
pub fn separation(t: &Triangle, voxel: UVec3) -> f64 {
    let centre = voxel.as_dvec3() + 0.5;
    let edges = [t[1] - t[0], t[2] - t[1], t[0] - t[2]];
    let mut axes = vec![DVec3::X, DVec3::Y, DVec3::Z, edges[0].cross(edges[1])];
    for edge in edges {
        axes.extend([DVec3::X, DVec3::Y, DVec3::Z].map(|axis| axis.cross(edge)));
    }
    let mut apart = f64::MIN;
    for axis in axes {
        let Some(axis) = axis.try_normalize() else { continue };
        let places = t.map(|p| axis.dot(p - centre));
        let low = places.into_iter().fold(f64::MAX, f64::min);
        let high = places.into_iter().fold(f64::MIN, f64::max);
        let reach = 0.5 * axis.abs().element_sum();
        apart = apart.max((low - reach).max(-reach - high));
    }
    apart
}

/// The voxels of the grid that a triangle's box (widened by `margin`) touches.
pub fn candidates(grid: &Grid, t: &Triangle, margin: f64) -> impl Iterator<Item = UVec3> {
    let size = grid.dimensions.as_dvec3();
    let low = t[0].min(t[1]).min(t[2]) - margin;
    let high = t[0].max(t[1]).max(t[2]) + margin;
    let first = (low.ceil() - 1.0).clamp(DVec3::ZERO, size).as_uvec3();
    let end = (high.floor() + 1.0).clamp(DVec3::ZERO, size).as_uvec3();
    (first.z..end.z).flat_map(move |z| {
        (first.y..end.y).flat_map(move |y| (first.x..end.x).map(move |x| UVec3::new(x, y, z)))
    })
}

/// For every voxel that a triangle comes nearer than `epsilon` to: the separation from the nearest.
pub fn separations(grid: &Grid, triangles: &[Triangle], epsilon: f64) -> BTreeMap<[u32; 3], f64> {
    let mut nearest = BTreeMap::new();
    for t in triangles.iter().filter(|t| !is_degenerate(t)) {
        for voxel in candidates(grid, t, epsilon) {
            let apart = separation(t, voxel);
            if apart <= epsilon {
                let entry = nearest.entry(voxel.to_array()).or_insert(apart);
                *entry = apart.min(*entry);
            }
        }
    }
    nearest
}

/// The triangle cut to a box (Sutherland and Hodgman 1974).
fn clip(t: &Triangle, low: DVec3, high: DVec3) -> Vec<DVec3> {
    let mut polygon = t.to_vec();
    for axis in 0..3 {
        for (sign, limit) in [(1.0, low[axis]), (-1.0, high[axis])] {
            let inside = |p: DVec3| sign * (p[axis] - limit);
            let mut cut = Vec::new();
            for (i, &p) in polygon.iter().enumerate() {
                let q = polygon[(i + 1) % polygon.len()];
                let (dp, dq) = (inside(p), inside(q));
                if dp >= 0.0 {
                    cut.push(p);
                }
                if (dp >= 0.0) != (dq >= 0.0) {
                    cut.push(p + (q - p) * (dp / (dp - dq)));
                }
            }
            polygon = cut;
        }
    }
    polygon
}

/// Vector area and centroid of a flat polygon.
fn area_and_centroid(polygon: &[DVec3]) -> (DVec3, DVec3) {
    let mut area = DVec3::ZERO;
    let mut moment = DVec3::ZERO;
    let Some((&first, rest)) = polygon.split_first() else { return (area, moment) };
    for pair in rest.windows(2) {
        let part = 0.5 * (pair[0] - first).cross(pair[1] - first);
        area += part;
        moment += part.length() * (first + pair[0] + pair[1]) / 3.0;
    }
    let size = area.length();
    (area, if size > 0.0 { moment / size } else { first })
}

/// The lobe of a normal: dominant axis (the lowest among nearly equal ones) and side.
pub fn lobe_of(normal: DVec3) -> usize {
    let size = normal.abs();
    let beats = 1.0 + 1.0 / 8192.0;
    let xy = usize::from(size.y > size.x * beats);
    let axis = if size.z > size[xy] * beats { 2 } else { xy };
    2 * axis + usize::from(normal[axis] < 0.0)
}

/// What a face collects.
#[derive(Clone, Copy, Debug, Default)]
pub struct Face {
    /// Vector area, not limited.
    pub area: DVec3,
    /// Position in grid space, weighted by the area along the lobe.
    pub moment: DVec3,
    /// The weights' sum.
    pub weight: f64,
    pub pieces: u32,
}

/// All faces by voxel and lobe, with pieces that lie in the plane between two voxels in the upper one.
pub fn faces(
    grid: &Grid,
    triangles: &[Triangle],
    double_sided: bool,
) -> BTreeMap<([u32; 3], usize), Face> {
    let mut faces: BTreeMap<_, Face> = BTreeMap::new();
    for t in triangles.iter().filter(|t| !is_degenerate(t)) {
        let lobe = lobe_of((t[1] - t[0]).cross(t[2] - t[0]));
        let axis = lobe / 2;
        for voxel in candidates(grid, t, 0.0) {
            let corner = voxel.as_dvec3();
            // All of it in the plane of the upper side: it belongs to the next voxel.
            if t.iter().all(|p| p[axis] >= corner[axis] + 1.0) {
                continue;
            }
            let (area, centroid) = area_and_centroid(&clip(t, corner, corner + 1.0));
            let weight = area[axis].abs();
            if weight <= 0.0 {
                continue;
            }
            let mut add = |lobe: usize, area: DVec3| {
                let face = faces.entry((voxel.to_array(), lobe)).or_default();
                face.area += area;
                face.moment += weight * centroid;
                face.weight += weight;
                face.pieces += 1;
            };
            add(lobe, area);
            if double_sided {
                add(lobe ^ 1, -area);
            }
        }
    }
    faces
}
