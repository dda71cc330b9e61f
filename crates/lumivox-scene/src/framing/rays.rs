//! All triangles of a scene, and their intersections with rays.
//!
//! Everything is in *unit space*: the middle of the scene's bounds is the origin, and the longest
//! edge is 1. So a scene in millimetres gives the same numbers as one in kilometres.
//!
//! The cost is bounded by vertex clustering (Rossignac and Borrel 1993, "Multi-resolution 3D
//! approximations for rendering complex scenes"): the vertices in a grid cell become one, and
//! triangles that collapse are dropped. Cells of 1e-6 only merge equal vertices; they grow while
//! there are too many triangles, or slivers whose boxes overlap, such as CAD's fans of thousands
//! around one corner. Dropping random triangles would be simpler, but a closed room must stay
//! closed.

use std::collections::hash_map::Entry;

use glam::{Mat4, Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::{Bvh2, leaf_collapser};
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};
use obvhs::ray::{Ray, RayHit};
use obvhs::rt_triangle::RtTriangle;
use rustc_hash::{FxHashMap, FxHashSet};

use super::directions;
use crate::{AlphaMode, Bounds, Instance, Material, Scene, Shading};

/// Lifts points off their surface: far more than the rounding error of a coordinate.
pub(super) const LIFT: f32 = 1e-4;
/// Surfaces closer together than this are one double-sided surface: fifty rounding errors.
const COINCIDENT: f32 = 3e-6;
/// Cells along the longest edge: at first, and for scenes that must be simplified.
const CELLS: [u32; 2] = [1 << 20, 1024];
const MOST_TRIANGLES: usize = 1_000_000;
/// Cells grow while a ray crosses more boxes of triangles than this on average; well-shaped
/// triangles give about ten.
const MOST_BOXES: f32 = 96.0;
/// The fewest cells along the longest edge that `MOST_BOXES` leads to.
const COARSEST: u32 = 32;

/// The transform of the scene to unit space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Unit {
    /// The middle of the bounds, m.
    center: Vec3,
    /// The longest edge of the bounds, m.
    pub(super) scale_m: f32,
    /// Half the edges of the bounds in unit space.
    pub(super) half: Vec3,
}

impl Unit {
    pub(super) fn unit_from_world(self, point: Vec3) -> Vec3 {
        (point - self.center) / self.scale_m
    }

    pub(super) fn world_from_unit(self, point: Vec3) -> Vec3 {
        self.center + point * self.scale_m
    }
}

/// The sides of a surface that block rays.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Sides {
    /// The front is visible; the back is transparent.
    Front,
    Both,
    /// Most light passes: a pane of glass blocks neither the sun nor a view.
    Transparent,
}

impl Sides {
    fn of(material: &Material) -> Self {
        let alpha = match &material.shading {
            Shading::MetallicRoughness(m) => m.base_color.w,
            Shading::Phong(p) => p.opacity,
            Shading::Unlit(u) => u.color.w,
        };
        let is_faint = material.alpha == AlphaMode::Blend && alpha < 0.5;
        if is_faint || material.transmission.factor > 0.5 {
            Self::Transparent
        } else if material.double_sided {
            Self::Both
        } else {
            Self::Front
        }
    }
}

#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle {
    pub(super) corners: [u32; 3],
    /// Index of the instance in the scene.
    pub(super) instance: u32,
    /// The number of the triangle in the instance's mesh.
    pub(super) number: u32,
    sides: Sides,
}

/// A point on a surface, and its weight among others.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Patch {
    /// Just above the surface.
    pub(super) position: Vec3,
    /// Unit normal of the visible side.
    pub(super) normal: Vec3,
    pub(super) weight: f32,
}

impl Patch {
    /// The patch on the other side of the surface.
    pub(super) fn other_side(self) -> Self {
        Self { position: self.position - 2.0 * LIFT * self.normal, normal: -self.normal, ..self }
    }
}

/// The first surface on a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Hit {
    /// The distance, in units of the direction's length.
    pub(super) distance: f32,
    /// Whether the ray comes from the front of the surface.
    pub(super) is_front: bool,
    pub(super) is_double_sided: bool,
    /// Unit normal, towards the ray's origin.
    pub(super) normal: Vec3,
    pub(super) position: Vec3,
    /// Index of the instance in the scene.
    pub(super) instance: u32,
}

impl Hit {
    pub(super) fn patch(&self) -> Patch {
        let position = self.position + self.normal * LIFT;
        Patch { position, normal: self.normal, weight: 1.0 }
    }
}

/// The triangles, ready for rays.
pub(super) struct Rays {
    pub(super) unit: Unit,
    pub(super) positions: Vec<Vec3>,
    pub(super) triangles: Vec<Triangle>,
    bvh: Bvh2,
    /// The index of each leaf's triangle; transparent triangles have no leaf.
    leaves: Vec<u32>,
    shapes: Vec<RtTriangle>,
}

impl Rays {
    pub(super) fn of(scene: &Scene) -> Self {
        let bounds = scene.bounds();
        // A scene of size zero is invalid, but must not divide by zero.
        let scale_m = bounds.size().max_element().max(f32::MIN_POSITIVE);
        let unit = Unit { center: bounds.center(), scale_m, half: bounds.size() * 0.5 / scale_m };
        let mut cells = CELLS[usize::from(scene.triangle_count() > MOST_TRIANGLES)];
        loop {
            let clustered = clustered(scene, unit, cells);
            let may_grow = |(positions, triangles): &(Vec<Vec3>, Vec<Triangle>)| {
                cells > COARSEST && boxes_on_the_way(positions, triangles, unit) > MOST_BOXES
            };
            match clustered.filter(|triangles| !may_grow(triangles)) {
                Some((positions, triangles)) => return Self::new(unit, positions, triangles),
                None => cells = (cells / 2).min(CELLS[1] / 2),
            }
        }
    }

    /// Builds the hierarchy (Benthin et al. 2022, "PLOC++", by the crate `obvhs`).
    fn new(unit: Unit, positions: Vec<Vec3>, triangles: Vec<Triangle>) -> Self {
        let is_solid = |&at: &u32| triangles[at as usize].sides != Sides::Transparent;
        let solid: Vec<u32> = (0..triangles.len() as u32).filter(is_solid).collect();
        let corners = |&at: &u32| {
            triangles[at as usize].corners.map(|corner| Vec3A::from(positions[corner as usize]))
        };
        let boxes: Vec<Aabb> = solid.iter().map(|at| Aabb::from_points(&corners(at))).collect();
        let order: Vec<u32> = (0..boxes.len() as u32).collect();
        // The steps of the crate's `fast_build`, whose helper reads a clock that browsers do not
        // have.
        let mut bvh =
            PlocBuilder::new().build(PlocSearchDistance::Low, &boxes, order, SortPrecision::U64, 2);
        leaf_collapser::collapse(&mut bvh, 8, 3.0);
        let leaves: Vec<u32> =
            bvh.primitive_indices.iter().map(|&index| solid[index as usize]).collect();
        let shapes = leaves.iter().map(corners).map(|[a, b, c]| RtTriangle::new(a, b, c)).collect();
        Self { unit, positions, triangles, bvh, leaves, shapes }
    }

    pub(super) fn corners(&self, triangle: &Triangle) -> [Vec3; 3] {
        triangle.corners.map(|corner| self.positions[corner as usize])
    }

    /// `count` points spread evenly over the area of some triangles, each with the weights of the
    /// triangle's corners (Turk 1990, "Generating random points in triangles"); the weights of the
    /// patches are their area.
    pub(super) fn spread<'a>(
        &self,
        triangles: &[&'a Triangle],
        count: usize,
    ) -> Vec<(&'a Triangle, [f32; 3], Patch)> {
        let mut total = 0.0;
        let up_to = triangles.iter().map(|triangle| {
            total += f64::from(self.area(triangle));
            total
        });
        let up_to: Vec<f64> = up_to.collect();
        let point = |(number, place): (usize, Vec3)| {
            let at = (number as f64 + 0.5) / count as f64 * total;
            let triangle = *triangles.get(up_to.partition_point(|&up_to| up_to <= at))?;
            let root = place.x.sqrt();
            let weights = [1.0 - root, root * (1.0 - place.y), root * place.y];
            let [a, b, c] = self.corners(triangle);
            let normal = (b - a).cross(c - a).try_normalize()?;
            let position = a * weights[0] + b * weights[1] + c * weights[2] + normal * LIFT;
            let weight = (total / count as f64) as f32;
            Some((triangle, weights, Patch { position, normal, weight }))
        };
        directions::cube(count).enumerate().filter_map(point).collect()
    }

    pub(super) fn area(&self, triangle: &Triangle) -> f32 {
        let [a, b, c] = self.corners(triangle);
        0.5 * (b - a).cross(c - a).length()
    }

    /// The first surface along a ray, from either side.
    pub(super) fn cast(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        let first = self.nearest(origin, direction, f32::INFINITY, |_| true)?;
        if first.is_front {
            return Some(first);
        }
        // If a front and a back coincide, pictures show the front.
        let limit = first.distance + COINCIDENT;
        let front = self.nearest(origin, direction, limit, |index| self.faces(index, direction));
        Some(front.filter(|hit| hit.distance >= first.distance - COINCIDENT).unwrap_or(first))
    }

    /// The first surface along a ray that a picture shows: rays pass the backs of single-sided
    /// surfaces.
    pub(super) fn cast_visible(&self, origin: Vec3, direction: Vec3) -> Option<Hit> {
        self.nearest(origin, direction, f32::INFINITY, |index| {
            self.triangle(index).is_double_sided() || self.faces(index, direction)
        })
    }

    /// Whether nothing is between a point and another at `distance`.
    pub(super) fn is_free(&self, origin: Vec3, direction: Vec3, distance: f32) -> bool {
        let ray = Ray::new(origin.into(), direction.into(), 0.0, distance);
        self.bvh.ray_traverse_miss(ray, |ray, index| self.shapes[index].intersect(ray))
    }

    /// The triangle of a leaf.
    fn triangle(&self, leaf: usize) -> &Triangle {
        &self.triangles[self.leaves[leaf] as usize]
    }

    /// Whether a triangle's front is towards the origin of a ray. `RtTriangle::ng` is the inverted
    /// normal.
    fn faces(&self, index: usize, direction: Vec3) -> bool {
        self.shapes[index].ng.dot(direction.into()) > 0.0
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
            if counts(index) { self.shapes[index].intersect(ray) } else { f32::INFINITY }
        });
        let index = hit.primitive_id as usize;
        let normal = Vec3::from(self.shapes.get(index)?.compute_normal());
        let is_front = self.faces(index, direction);
        Some(Hit {
            distance: hit.t,
            is_front,
            is_double_sided: self.triangle(index).is_double_sided(),
            normal: if is_front { normal } else { -normal },
            position: origin + direction * hit.t,
            instance: self.triangle(index).instance,
        })
    }
}

impl Triangle {
    pub(super) fn is_double_sided(&self) -> bool {
        self.sides == Sides::Both
    }
}

/// The triangles after merging the vertices of each cell into its first vertex, so that flat
/// surfaces stay flat; `None` if there are too many.
fn clustered(scene: &Scene, unit: Unit, cells: u32) -> Option<(Vec<Vec3>, Vec<Triangle>)> {
    let sides = |instance: &Instance| {
        scene.materials.get(instance.material).map_or(Sides::Front, Sides::of)
    };
    // If there is only glass, the glass is the subject.
    let is_glass = scene.subjects().all(|instance| sides(instance) == Sides::Transparent);
    let into_unit =
        Mat4::from_scale(Vec3::splat(1.0 / unit.scale_m)) * Mat4::from_translation(-unit.center);
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut vertex_of_cell: FxHashMap<[u32; 3], u32> = FxHashMap::default();
    let mut known: FxHashSet<[u32; 3]> = FxHashSet::default();
    let mut vertices = Vec::new();
    for (index, instance) in (0..).zip(&scene.instances) {
        let Some(mesh) = scene.meshes.get(instance.mesh) else { continue };
        if instance.is_hidden || instance.is_backdrop {
            continue;
        }
        let sides = if is_glass { Sides::Both } else { sides(instance) };
        let unit_from_local = into_unit * instance.world_from_local;
        vertices.clear();
        for &local in &mesh.positions {
            let position = unit_from_local.transform_point3(local);
            // Positions near the largest float may overflow; a wrong corner is harmless.
            let position = if position.is_finite() { position } else { Vec3::ZERO };
            let cell = ((position + unit.half) * cells as f32).as_uvec3().to_array();
            vertices.push(match vertex_of_cell.entry(cell) {
                Entry::Occupied(entry) => *entry.get(),
                Entry::Vacant(entry) => {
                    positions.push(position);
                    *entry.insert(positions.len() as u32 - 1)
                }
            });
        }
        for (number, triangle) in (0..).zip(mesh.triangles()) {
            let corners = triangle.map(|index| vertices[index]);
            let [a, b, c] = corners;
            if a == b || b == c || c == a {
                continue;
            }
            // In large cells, triangles may become equal, except for their first corner.
            let mut key = corners;
            while key[0] != a.min(b).min(c) {
                key.rotate_left(1);
            }
            if cells > CELLS[1] || known.insert(key) {
                triangles.push(Triangle { corners, instance: index, number, sides });
            }
        }
        if triangles.len().max(positions.len()) > MOST_TRIANGLES && cells > 1 {
            return None;
        }
    }
    Some((positions, triangles))
}

/// The mean number of triangle boxes that a ray through the scene's own box crosses: the ratio of
/// their areas (`MacDonald` and Booth 1990, "Heuristics for ray tracing using space subdivision",
/// section 3).
fn boxes_on_the_way(positions: &[Vec3], triangles: &[Triangle], unit: Unit) -> f32 {
    let area = |size: Vec3| f64::from(size.x * size.y + size.y * size.z + size.z * size.x);
    let boxes = triangles.iter().map(|triangle| {
        let corners = triangle.corners.map(|corner| positions[corner as usize]);
        area(Bounds::from_points(corners).size())
    });
    (boxes.sum::<f64>() / area(2.0 * unit.half).max(f64::MIN_POSITIVE)) as f32
}
