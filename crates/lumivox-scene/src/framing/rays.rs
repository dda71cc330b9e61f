//! Rays against a scene's triangles: the first surface in a direction, its distance, and whether
//! its front or its back is seen.
//!
//! Triangles and rays are in *unit space*: the middle of the scene's bounds is the origin, and the
//! longest edge is 1. So a scene in millimetres has the same numbers as one in kilometres, and no
//! step has a tolerance in metres.

use std::cell::Cell;

use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, leaf_collapser};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;

use super::soup::{Sides, Soup, Unit};
use crate::Scene;

/// Surfaces that are closer together than this count as one double-sided surface: a wall without
/// thickness. Fifty times the rounding error of a coordinate in unit space.
const COINCIDENT: f32 = 3e-6;

/// Lifts points off their surface: far more than the rounding error of a coordinate.
pub(super) const LIFT: f32 = 1e-4;

/// The first surface on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// The distance, in units of the direction's length.
    pub(super) distance: f32,
    /// Whether the ray comes from the front of the surface.
    pub(super) is_front: bool,
    /// Whether the surface's back is visible, too.
    pub(super) is_double_sided: bool,
    /// Unit normal, towards the ray's origin.
    pub(super) normal: Vec3,
    /// The position.
    pub(super) position: Vec3,
    /// The instance that it belongs to.
    pub(super) part: u32,
}

impl Hit {
    /// A point just above the surface, for rays to start from.
    pub(super) fn lifted(&self) -> Vec3 {
        self.position + self.normal * LIFT
    }
}

/// The triangles, ready for rays.
pub(super) struct Rays {
    bvh: Bvh2,
    /// In the order of the leaves.
    triangles: Vec<RtTriangle>,
    part: Vec<u32>,
    /// For each instance.
    sides: Vec<Sides>,
    /// The number of triangle tests so far.
    tests: Cell<u64>,
}

/// The most boxes of triangles that a ray may cross on average: well-shaped triangles give about
/// ten.
const MOST_BOXES: f32 = 96.0;
/// The fewest cells along the longest edge when clustering reduces the boxes.
const COARSEST: u32 = 32;

impl Rays {
    /// The triangles of a scene and rays against them, at a bounded cost.
    ///
    /// Slivers, as in the fans of thousands around one corner that CAD writes, have overlapping
    /// boxes, and no hierarchy of boxes avoids testing a ray against most of them. So the boxes on
    /// a ray's way are estimated first, and while they are too many, vertices are clustered in
    /// larger cells.
    pub(super) fn of(scene: &Scene, unit: Unit) -> (Soup, Self) {
        let mut soup = Soup::of(scene, unit);
        let mut cells = Soup::FINEST;
        while boxes_on_the_way(&soup, unit.half) > MOST_BOXES && cells > COARSEST {
            cells /= 2;
            soup = Soup::in_cells(scene, unit, cells);
            tracing::debug!("slivers: simplified to {} triangles", soup.triangles.len());
        }
        let rays = Self::new(&soup);
        (soup, rays)
    }

    /// The number of triangle tests so far.
    #[cfg(test)]
    pub(super) fn tests(&self) -> u64 {
        self.tests.get()
    }

    /// Builds the hierarchy (Benthin et al. 2022, "PLOC++", by the crate `obvhs`). It takes about
    /// 110 bytes a triangle, and 230 while it is built.
    pub(super) fn new(soup: &Soup) -> Self {
        let is_solid = |&i: &usize| soup.sides[soup.part[i] as usize] != Sides::Transparent;
        let solid: Vec<usize> = (0..soup.triangles.len()).filter(is_solid).collect();
        let corners =
            |i: usize| soup.triangles[i].map(|corner| Vec3A::from(soup.positions[corner as usize]));
        let boxes: Vec<Aabb> = solid.iter().map(|&i| Aabb::from_points(&corners(i))).collect();
        let order: Vec<u32> = (0..boxes.len() as u32).collect();
        // The crate's own `fast_build`, spelled out because its helper reads the clock, which
        // browsers do not have.
        let mut bvh =
            PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, order, SortPrecision::U64, 2);
        leaf_collapser::collapse(&mut bvh, 8, 3.0);
        let (mut triangles, mut part) = (Vec::new(), Vec::new());
        for &index in &bvh.primitive_indices {
            let index = solid[index as usize];
            let [a, b, c] = corners(index);
            triangles.push(RtTriangle::new(a, b, c));
            part.push(soup.part[index]);
        }
        Self { bvh, triangles, part, sides: soup.sides.clone(), tests: Cell::new(0) }
    }

    /// The first surface along a ray, from either side.
    pub(super) fn cast(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let first = self.nearest(origin, direction, f32::INFINITY, |_| true)?;
        if first.is_front {
            return Some(first);
        }
        // If a front is at the same position, pictures show the front.
        let limit = first.distance + COINCIDENT;
        let front = self.nearest(origin, direction, limit, |index| self.faces(index, direction));
        Some(front.filter(|hit| hit.distance >= first.distance - COINCIDENT).unwrap_or(first))
    }

    /// The first surface along a ray that a picture shows: rays pass the backs of single-sided
    /// surfaces.
    pub(super) fn cast_visible(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.nearest(origin, direction, f32::INFINITY, |index| {
            self.is_double_sided(index) || self.faces(index, direction)
        })
    }

    /// Whether nothing is between a point and another at `distance`.
    pub(super) fn is_free(&self, origin: Vec3, direction: Vec3, distance: f32) -> bool {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, distance);
        self.bvh.ray_traverse_miss(ray, |ray, index| {
            self.count_test();
            self.triangles[index].intersect(ray)
        })
    }

    fn count_test(&self) {
        self.tests.set(self.tests.get() + 1);
    }

    /// Whether a triangle's front is towards the origin of a ray. `RtTriangle::ng` is the inverted
    /// normal.
    fn faces(&self, index: usize, direction: Vec3) -> bool {
        self.triangles[index].ng.dot(direction.into()) > 0.0
    }

    fn is_double_sided(&self, index: usize) -> bool {
        self.sides[self.part[index] as usize] == Sides::Both
    }

    fn nearest(
        &self,
        origin: Vec3,
        direction: Vec3,
        limit: f32,
        counts: impl Fn(usize) -> bool,
    ) -> Option<Hit> {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, limit);
        let mut hit = RayHit::none();
        self.bvh.ray_traverse(ray, &mut hit, |ray, index| {
            self.count_test();
            if counts(index) { self.triangles[index].intersect(ray) } else { f32::INFINITY }
        });
        let index = hit.primitive_id as usize;
        let triangle = self.triangles.get(index)?;
        let is_front = self.faces(index, direction);
        let normal = Vec3::from(triangle.compute_normal());
        Some(Hit {
            distance: hit.t,
            is_front,
            is_double_sided: self.is_double_sided(index),
            part: self.part[index],
            position: origin + direction * hit.t,
            normal: if is_front { normal } else { -normal },
        })
    }
}

/// The mean number of triangle boxes that a ray through the scene's own box crosses: the ratio of
/// their areas (`MacDonald` and Booth 1990, "Heuristics for ray tracing using space subdivision",
/// section 3).
fn boxes_on_the_way(soup: &Soup, half: Vec3) -> f32 {
    let area = |size: Vec3| 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
    let boxes = (0..soup.triangles.len()).map(|triangle| {
        let [a, b, c] = soup.corners_of(triangle);
        f64::from(area(a.max(b).max(c) - a.min(b).min(c)))
    });
    boxes.sum::<f64>() as f32 / area(2.0 * half).max(f32::MIN_POSITIVE)
}

#[cfg(test)]
mod tests {
    use super::super::soup::Soup;
    use super::*;

    /// Squares of edge 0.5 at heights, the front up or down.
    fn floors(floors: &[(f32, bool, Sides)]) -> Rays {
        let mut soup = Soup::default();
        for &(y, is_up, sides) in floors {
            let first = soup.positions.len() as u32;
            soup.positions.extend(
                [(-1.0, -1.0), (-1.0, 1.0), (1.0, 1.0), (1.0, -1.0)]
                    .map(|(x, z)| Vec3::new(0.25 * x, y, 0.25 * z)),
            );
            for triangle in [[0, 1, 2], [0, 2, 3]] {
                let [a, b, c] = triangle.map(|corner: u32| first + corner);
                soup.triangles.push(if is_up { [a, b, c] } else { [a, c, b] });
                soup.part.push(soup.sides.len() as u32);
            }
            soup.sides.push(sides);
        }
        Rays::new(&soup)
    }

    const FROM: Vec3 = Vec3::new(0.02, 0.4, 0.1);

    #[test]
    fn rays_distinguish_fronts_from_backs() {
        for is_up in [true, false] {
            let rays = floors(&[(0.1, is_up, Sides::Front)]);
            let hit = rays.cast(FROM, Vec3::NEG_Y).unwrap();
            assert!((hit.distance - 0.3).abs() < 1e-6 && hit.is_front == is_up);
            assert!(hit.normal.abs_diff_eq(Vec3::Y, 1e-6));
            assert!((hit.position.y - 0.1).abs() < 1e-6 && hit.lifted().y > 0.1);
            assert_eq!(rays.cast(FROM, Vec3::Y), None);
            assert_eq!(rays.cast(FROM, Vec3::X), None);
        }
    }

    #[test]
    fn visible_rays_pass_backs_and_panes() {
        let rays = floors(&[
            (0.3, true, Sides::Transparent),
            (0.2, false, Sides::Front),
            (0.1, false, Sides::Both),
        ]);
        assert!((rays.cast(FROM, Vec3::NEG_Y).unwrap().distance - 0.2).abs() < 1e-6);
        let shown = rays.cast_visible(FROM, Vec3::NEG_Y).unwrap();
        assert!((shown.distance - 0.3).abs() < 1e-6 && shown.part == 2);
        assert!(rays.is_free(FROM, Vec3::NEG_Y, 0.19) && !rays.is_free(FROM, Vec3::NEG_Y, 0.21));
    }

    #[test]
    fn coincident_front_and_back_count_as_front() {
        for order in [[true, false], [false, true]] {
            let rays = floors(&order.map(|is_up| (0.1, is_up, Sides::Front)));
            assert!(rays.cast(FROM, Vec3::NEG_Y).unwrap().is_front);
            let below = Vec3::new(0.1, -0.4, 0.0);
            assert!(rays.cast(below, Vec3::Y).unwrap().is_front);
        }
    }

    #[test]
    fn rays_in_an_empty_scene_hit_nothing() {
        let rays = Rays::new(&Soup::default());
        assert_eq!(rays.cast(FROM, Vec3::NEG_Y), None);
        assert!(rays.is_free(FROM, Vec3::X, f32::INFINITY));
    }
}
