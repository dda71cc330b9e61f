//! Dividing polygons into triangles.
//!
//! Triangles and convex polygons are fans around their first corner; others are divided by ear
//! clipping (Meisters 1975, "Polygons have ears"; the `earcut` crate) in the plane of the polygon.
//! That plane's normal is Newell's (Sutherland, Sproull, Schumacker 1974, "A characterization of
//! ten hidden-surface algorithms", after M. Newell): the mean over all corners, which also exists
//! for polygons that are not quite flat.

use earcut::Earcut;
use glam::{DVec2, DVec3, Vec3};

/// Polygons with more corners always become fans: clipping a polygon that crosses itself everywhere
/// takes quadratic time.
const MOST_CLIPPED: usize = 20_000;

/// Divides polygons; reuses its memory.
#[derive(Default)]
pub(super) struct Cutter {
    earcut: Earcut<f64>,
    points: Vec<DVec2>,
    flat: Vec<[f64; 2]>,
    triangles: Vec<u32>,
}

impl Cutter {
    /// Divides a polygon into triangles of the same winding, as indices of its corners.
    pub(super) fn cut(&mut self, corners: &[Vec3]) -> &[u32] {
        self.triangles.clear();
        if corners.len() > 3 && corners.len() <= MOST_CLIPPED {
            self.project(corners);
            if !is_convex(&self.points) {
                self.clip();
            }
        }
        // Also makes a fan if the polygon has no plane, or no ears.
        if self.triangles.is_empty() {
            let last = corners.len().saturating_sub(1) as u32;
            self.triangles.extend((1..last).flat_map(|i| [0, i, i + 1]));
        }
        &self.triangles
    }

    /// The corners projected to the polygon's plane, in which it runs counter-clockwise; empty if
    /// it has no plane.
    fn project(&mut self, corners: &[Vec3]) {
        self.points.clear();
        // Relative to the first corner, since products of large coordinates lose the digits in
        // which corners differ.
        let origin = corners[0].as_dvec3();
        let at = |i: usize| corners[i % corners.len()].as_dvec3() - origin;
        let normal: DVec3 = (0..corners.len()).map(|i| at(i).cross(at(i + 1))).sum();
        let Some(normal) = normal.try_normalize() else { return };
        let (right, up) = normal.any_orthonormal_pair();
        self.points.extend((0..corners.len()).map(|i| DVec2::new(at(i).dot(right), at(i).dot(up))));
    }

    fn clip(&mut self) {
        if self.points.is_empty() {
            return;
        }
        self.flat.clear();
        self.flat.extend(self.points.iter().map(DVec2::to_array));
        self.earcut.earcut_slice(&self.flat, &[], &mut self.triangles);
        for triangle in self.triangles.chunks_exact_mut(3) {
            let [a, b, c] = [0, 1, 2].map(|i| self.points[triangle[i] as usize]);
            if (b - a).perp_dot(c - a) < 0.0 {
                triangle.swap(1, 2);
            }
        }
    }
}

/// Whether a polygon turns left at every corner, and makes only one full turn.
fn is_convex(points: &[DVec2]) -> bool {
    let count = points.len();
    let edge = |i: usize| points[(i + 1) % count] - points[i % count];
    // In one full turn, x changes its direction twice; in a star, more often.
    let mut turns = 0;
    for i in 0..count {
        let (this, next) = (edge(i), edge(i + 1));
        if this.perp_dot(next) <= 0.0 {
            return false;
        }
        turns += usize::from((this.x < 0.0) != (next.x < 0.0));
    }
    count >= 3 && turns <= 2
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Twice the signed area of each triangle, seen from `normal`.
    fn areas(corners: &[Vec3], normal: Vec3) -> Vec<f32> {
        let mut cutter = Cutter::default();
        let triangles = cutter.cut(corners);
        triangles
            .chunks_exact(3)
            .map(|t| {
                let [a, b, c] = [t[0], t[1], t[2]].map(|i| corners[i as usize]);
                (b - a).cross(c - a).dot(normal)
            })
            .collect()
    }

    /// An L of area 3, rotated out of the plane z = 0 and far from the origin.
    fn letter() -> (Vec<Vec3>, Vec3) {
        let turn = glam::Quat::from_euler(glam::EulerRot::XYZ, 0.7, -1.1, 2.0);
        let flat = [(1., 1.), (1., 2.), (0., 2.), (0., 0.), (2., 0.), (2., 1.)];
        let corners = flat.map(|(x, y)| turn * Vec3::new(x, y, 0.0) + Vec3::splat(100.0));
        (corners.to_vec(), turn * Vec3::Z)
    }

    #[test]
    fn a_concave_polygon_is_covered_once() {
        let (mut corners, normal) = letter();
        for _ in 0..corners.len() {
            corners.rotate_left(1);
            let areas = areas(&corners, normal);
            assert_eq!(areas.len(), 4);
            assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
            assert!((areas.iter().sum::<f32>() - 6.0).abs() < 1e-3);
        }
        corners.reverse();
        let areas = areas(&corners, -normal);
        assert!(areas.iter().all(|&area| area > 0.0), "{areas:?}");
    }

    #[test]
    fn convex_polygons_are_fans() {
        let corners: Vec<Vec3> =
            (0..7).map(|i| Vec3::from((glam::Vec2::from_angle(i as f32 * 0.8), 3.0))).collect();
        let mut cutter = Cutter::default();
        assert_eq!(cutter.cut(&corners), [0, 1, 2, 0, 2, 3, 0, 3, 4, 0, 4, 5, 0, 5, 6]);
        assert_eq!(cutter.cut(&corners[..3]), [0, 1, 2]);
        assert!(cutter.cut(&corners[..2]).is_empty());
        assert!(cutter.cut(&[]).is_empty());
    }

    #[test]
    fn degenerate_and_very_long_polygons_become_fans() {
        let mut cutter = Cutter::default();
        assert_eq!(cutter.cut(&[Vec3::ONE; 4]), [0, 1, 2, 0, 2, 3]);
        let line = [0.0, 1.0, 2.0, 3.0].map(Vec3::splat);
        assert_eq!(cutter.cut(&line), [0, 1, 2, 0, 2, 3]);
        let many = vec![Vec3::X; MOST_CLIPPED + 1];
        assert_eq!(cutter.cut(&many).len(), (MOST_CLIPPED - 1) * 3);
    }

    #[test]
    fn self_intersecting_polygons_are_cut_in_bounded_time() {
        // A polygon of random chords: every edge crosses most others.
        let mut state = 1_u32;
        let mut random = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (state >> 8) as f32 / 16_777_216.0
        };
        let corners: Vec<_> = (0..2000).map(|_| Vec3::new(random(), random(), 0.0)).collect();
        let mut cutter = Cutter::default();
        let triangles = cutter.cut(&corners);
        assert!(triangles.iter().all(|&i| (i as usize) < corners.len()));
    }
}
