//! The voxelizer in f64, by brute force: every voxel in a triangle's box by separating axes, every
//! piece by clipping. Slow, plain, and independent of the shaders.

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

/// A triangle's ranges along the axes that may separate it from voxels.
pub struct Separator(Vec<Axis>);

struct Axis {
    direction: DVec3,
    /// The triangle's range along the axis, widened by half a voxel's extent.
    low: f64,
    high: f64,
}

impl Separator {
    /// All axes that separate a triangle from boxes.
    pub fn new(t: &Triangle) -> Self {
        let edges = edges(t);
        let across = edges.into_iter().flat_map(|edge| DVec3::AXES.map(|axis| axis.cross(edge)));
        Self::along(t, std::iter::once(edges[0].cross(edges[1])).chain(DVec3::AXES).chain(across))
    }

    /// Only the tests of a conservative rasterizer along `axis`, and of the plane's depths over the
    /// pixel: without the edges as seen along the other axes.
    #[allow(dead_code)] // The tests of lumivox-classics use it.
    pub fn in_column(t: &Triangle, axis: usize) -> Self {
        let edges = edges(t);
        let across = edges.map(|edge| edge.cross(DVec3::AXES[axis]));
        Self::along(t, std::iter::once(edges[0].cross(edges[1])).chain(DVec3::AXES).chain(across))
    }

    fn along(t: &Triangle, directions: impl Iterator<Item = DVec3>) -> Self {
        let axis = |direction: DVec3| {
            let places = t.map(|p| direction.dot(p));
            let reach = 0.5 * direction.abs().element_sum();
            let low = places.into_iter().fold(f64::MAX, f64::min) - reach;
            let high = places.into_iter().fold(f64::MIN, f64::max) + reach;
            Axis { direction, low, high }
        };
        Self(directions.filter_map(DVec3::try_normalize).map(axis).collect())
    }

    /// Largest distance of the triangle and the closed voxel along any axis, in voxels (negative:
    /// overlap); `None` if above `most`.
    pub fn apart(&self, voxel: UVec3, most: f64) -> Option<f64> {
        let centre = voxel.as_dvec3() + 0.5;
        self.0.iter().try_fold(f64::MIN, |apart, axis| {
            let place = axis.direction.dot(centre);
            let apart = apart.max(axis.low - place).max(place - axis.high);
            (apart <= most).then_some(apart)
        })
    }
}

fn edges(t: &Triangle) -> [DVec3; 3] {
    [t[1] - t[0], t[2] - t[1], t[0] - t[2]]
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

/// For every voxel within `epsilon` of a triangle: the separation from the nearest one.
pub fn separations(grid: &Grid, triangles: &[Triangle], epsilon: f64) -> BTreeMap<[u32; 3], f64> {
    let mut nearest = BTreeMap::new();
    for t in triangles.iter().filter(|t| !is_degenerate(t)) {
        let separator = Separator::new(t);
        for voxel in candidates(grid, t, epsilon) {
            if let Some(apart) = separator.apart(voxel, epsilon) {
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

/// The sums of a face.
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

/// All faces by voxel and lobe, with pieces that lie in the plane between two voxels in the upper
/// one.
pub fn faces(
    grid: &Grid,
    triangles: &[Triangle],
    double_sided: bool,
) -> BTreeMap<([u32; 3], usize), Face> {
    let mut faces: BTreeMap<_, Face> = BTreeMap::new();
    for t in triangles.iter().filter(|t| !is_degenerate(t)) {
        let lobe = lobe_of((t[1] - t[0]).cross(t[2] - t[0]));
        let axis = lobe / 2;
        let separator = Separator::new(t);
        for voxel in candidates(grid, t, 0.0) {
            // Most of a large triangle's box is far from it. Touching voxels may be separated by
            // rounding.
            if separator.apart(voxel, 1e-9).is_none() {
                continue;
            }
            let corner = voxel.as_dvec3();
            // A piece in the plane of the upper side belongs to the next voxel.
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
