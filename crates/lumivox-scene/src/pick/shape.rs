//! One mesh, in its local space, in a hierarchy of boxes.

use glam::{DVec3, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray, RayHit};

use crate::Mesh;

/// Triangles of one leaf: boxes then take 1 byte a triangle, and a ray tests a few hundred
/// triangles.
const RUN: usize = 32;
/// Padding of the boxes, in units of half the mesh's longest edge; corners and rays are rounded to
/// 1e-7 of that.
const PADDING: f32 = 1e-5;
/// The farthest start of a ray from the centre, in the same units; the corners are at sqrt(3).
const REACH: f64 = 2.0;

/// The triangles of a mesh.
pub(super) struct Shape {
    positions: Vec<Vec3>,
    /// One normal per position, or empty.
    normals: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
    bvh: Bvh2,
    center: DVec3,
    half: f64,
}

/// The sides of triangles that a ray hits, by their winding as seen from its origin.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Sides {
    Both,
    CounterClockwise,
    Clockwise,
}

/// A hit of a ray on a triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    pub(super) triangle: usize,
    /// The distance in units of the direction's length.
    pub(super) distance: f64,
    /// Weights of the second and the third corner.
    weights: [f64; 2],
}

impl Shape {
    /// The shape of a mesh; `None` without triangles.
    pub(super) fn new(mesh: &Mesh) -> Option<Self> {
        let is_there = |corner: &usize| *corner < mesh.positions.len();
        let triangles: Vec<[u32; 3]> = mesh
            .triangles()
            // Invalid indices become an empty triangle.
            .map(|triangle| if triangle.iter().all(is_there) { triangle } else { [0; 3] })
            .map(|triangle| triangle.map(|corner| corner as u32))
            .collect();
        let (low, high) = mesh
            .positions
            .iter()
            .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(low, high), position| {
                (low.min(*position), high.max(*position))
            });
        if triangles.is_empty() || !(low.is_finite() && high.is_finite()) {
            return None;
        }
        let (low, high) = (low.as_dvec3(), high.as_dvec3());
        let center = 0.5 * (low + high);
        let half = (0.5 * (high - low)).max_element().max(f64::from(f32::MIN_POSITIVE));
        let boxed = |run: &[[u32; 3]]| {
            let corners: Vec<Vec3A> = run
                .iter()
                .flatten()
                .map(|&corner| {
                    let position = mesh.positions[corner as usize].as_dvec3();
                    ((position - center) / half).as_vec3a()
                })
                .collect();
            let mut tight = Aabb::from_points(&corners);
            tight.min -= PADDING;
            tight.max += PADDING;
            tight
        };
        let boxes: Vec<Aabb> = triangles.chunks(RUN).map(boxed).collect();
        let order: Vec<u32> = (0..boxes.len() as u32).collect();
        // The crate's helper reads a clock that browsers do not have.
        let bvh =
            PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, order, SortPrecision::U64, 2);
        let has_normals = mesh.normals.len() == mesh.positions.len();
        let normals = if has_normals { mesh.normals.clone() } else { Vec::new() };
        Some(Self { positions: mesh.positions.clone(), normals, triangles, bvh, center, half })
    }

    /// The nearest triangle on a ray that is nearer than `limit`; of several at the same distance,
    /// the one with the lowest index.
    pub(super) fn nearest(
        &self,
        (origin, direction): (DVec3, DVec3),
        sides: Sides,
        limit: f64,
    ) -> Option<Hit> {
        // The ray in the space of the boxes, from a start near them, so that 32 bits are enough for
        // distant eyes.
        let length = direction.length() / self.half;
        let towards = direction.try_normalize()?;
        let from = (origin - self.center) / self.half;
        let skipped = (-from.dot(towards) - REACH).max(0.0);
        let start = (from + skipped * towards).as_vec3a();
        let reach = limit * length - skipped;
        if reach < 0.0 || !start.is_finite() {
            return None;
        }
        // Slightly more than the distance, so that rounding does not separate equal hits.
        let bounded = |reach: f64| (reach * (1.0 + 1e-6) + f64::from(PADDING)) as f32;
        let ray = Ray::new(start, towards.as_vec3a(), 0.0, bounded(reach));
        let mut nearest: Option<Hit> = None;
        let mut unused = RayHit::none();
        self.bvh.ray_traverse(ray, &mut unused, |_, leaf| {
            let run = self.bvh.primitive_indices[leaf] as usize;
            for triangle in run * RUN..self.triangles.len().min((run + 1) * RUN) {
                let Some(hit) = self.meet(triangle, origin, direction, sides) else { continue };
                let is_first = nearest.is_none_or(|nearest| {
                    (hit.distance, triangle) < (nearest.distance, nearest.triangle)
                });
                if hit.distance < limit && is_first {
                    nearest = Some(hit);
                }
            }
            nearest.map_or(f32::INFINITY, |hit| bounded(hit.distance * length - skipped))
        });
        nearest
    }

    fn meet(&self, triangle: usize, origin: DVec3, direction: DVec3, sides: Sides) -> Option<Hit> {
        let [a, b, c] = self.corners(triangle);
        let (to_b, to_c) = (b - a, c - a);
        let across = direction.cross(to_c);
        // Positive if the triangle is counter-clockwise as seen by the ray.
        let determinant = to_b.dot(across);
        let is_wanted = match sides {
            Sides::Both => determinant != 0.0,
            Sides::CounterClockwise => determinant > 0.0,
            Sides::Clockwise => determinant < 0.0,
        };
        if !is_wanted {
            return None;
        }
        let from_a = origin - a;
        let second = from_a.dot(across) / determinant;
        let beside = from_a.cross(to_b);
        let third = direction.dot(beside) / determinant;
        let distance = to_c.dot(beside) / determinant;
        let is_inside = second >= 0.0 && third >= 0.0 && second + third <= 1.0;
        (is_inside && distance >= 0.0).then_some(Hit {
            triangle,
            distance,
            weights: [second, third],
        })
    }

    /// The corners of a triangle.
    pub(super) fn corners(&self, triangle: usize) -> [DVec3; 3] {
        self.triangles[triangle].map(|corner| self.positions[corner as usize].as_dvec3())
    }

    /// The normal interpolated between the vertices; zero without normals.
    pub(super) fn normal(&self, hit: Hit) -> Vec3 {
        let [second, third] = hit.weights.map(|weight| weight as f32);
        let [a, b, c] = self.triangles[hit.triangle]
            .map(|corner| self.normals.get(corner as usize).copied().unwrap_or(Vec3::ZERO));
        a * (1.0 - second - third) + b * second + c * third
    }
}
