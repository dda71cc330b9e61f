//! Picking by rays: which instance and triangle a ray hits, and where.
//!
//! Each mesh is stored once, in its local space, as runs of 32 triangles in the file's order,
//! mostly neighbours on the surface, in a hierarchy of boxes (`obvhs`). A ray is transformed to the
//! space of each instance. This takes 24 bytes a triangle if triangles share vertices (85 if none
//! do), and a second for 10 million triangles; a scene in motion only pays for its instances.
//! Triangles are tested in 64 bits (Möller and Trumbore 1997, "Fast, minimum storage ray/triangle
//! intersection").

mod shape;
#[cfg(test)]
mod tests;

use glam::{DMat4, DVec3, IVec3, Mat3, Mat4, Vec3};

use crate::Scene;
use shape::{Hit, Shape, Sides};

/// The triangles of a scene, prepared for rays on the CPU. Make a new one after each change of the
/// scene.
pub struct Picker {
    /// A shape for each mesh; `None` if no instance shows it.
    shapes: Vec<Option<Shape>>,
    placed: Vec<PlacedShape>,
}

/// An instance that is not hidden.
#[derive(Debug)]
struct PlacedShape {
    instance: usize,
    mesh: usize,
    world_from_local: Mat4,
    local_from_world: DMat4,
    sides: Sides,
}

/// The first surface that a ray hits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pick {
    /// Index into [`Scene::instances`].
    pub instance: usize,
    /// The number of the triangle in the instance's mesh: its indices begin at three times this
    /// number.
    pub triangle: usize,
    /// The point that was hit, in the world, m.
    pub position: Vec3,
    /// The unit normal of the triangle's plane in the world, towards the ray's origin.
    pub normal: Vec3,
    /// The unit normal interpolated between the vertices (without a normal texture), on the visible
    /// side.
    pub shading_normal: Vec3,
    /// Distance from the ray's origin, m.
    pub distance_m: f32,
}

impl std::fmt::Debug for Picker {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Picker").field("placed", &self.placed.len()).finish_non_exhaustive()
    }
}

impl Picker {
    /// Makes a picker for a valid scene (see [`Scene::validate`]); it stores copies of the
    /// triangles.
    ///
    /// Takes 24 bytes a triangle, and about a tenth of a second per million (debug build, one slow
    /// core).
    pub fn new(scene: &Scene) -> Self {
        let mut is_shown = vec![false; scene.meshes.len()];
        let mut all = Vec::new();
        let pickable = scene.instances.iter().enumerate().filter(|(_, placed)| !placed.is_hidden);
        for (instance, placed) in pickable {
            let Some(is_shown) = is_shown.get_mut(placed.mesh) else { continue };
            *is_shown = true;
            let local_from_world = placed.world_from_local.as_dmat4().inverse();
            let material = scene.materials.get(placed.material);
            // Fronts are counter-clockwise in the world; if the transform mirrors, clockwise in
            // local space.
            let sides = if material.is_some_and(|material| material.double_sided) {
                Sides::Both
            } else if local_from_world.determinant() < 0.0 {
                Sides::Clockwise
            } else {
                Sides::CounterClockwise
            };
            all.push(PlacedShape {
                instance,
                mesh: placed.mesh,
                world_from_local: placed.world_from_local,
                local_from_world,
                sides,
            });
        }
        let shape = |(mesh, is_shown)| if is_shown { Shape::new(mesh) } else { None };
        let shapes = scene.meshes.iter().zip(is_shown).map(shape).collect();
        Self { shapes, placed: all }
    }

    /// The first surface on a ray that a picture shows: rays pass the backs of single-sided
    /// surfaces, as in pictures. Masks and glass do not let rays pass: a leaf or a pane is hit
    /// everywhere. `direction` need not have unit length; a zero direction hits nothing.
    ///
    /// If several surfaces are at the same position, the first instance is returned.
    pub fn pick(&self, origin: Vec3, direction: Vec3) -> Option<Pick> {
        let origin = origin.as_dvec3();
        let direction = direction.as_dvec3().try_normalize()?;
        let ray = (origin, direction);
        let (placed, hit) = self.nearest(ray, f64::INFINITY, |placed| placed.sides)?;
        let shape = self.shapes[placed.mesh].as_ref()?;
        Some(placed.tell(shape, hit, (origin, direction)))
    }

    /// The distance, m, to the first surface on a ray that blocks light, from either side.
    pub fn obstacle_m(&self, origin: Vec3, direction: Vec3) -> Option<f32> {
        let direction = direction.as_dvec3().try_normalize()?;
        let ray = (origin.as_dvec3(), direction);
        let (_, hit) = self.nearest(ray, f64::INFINITY, |_| Sides::Both)?;
        Some(hit.distance as f32)
    }

    /// The distance, m, to the first surface on a ray that is at most `reach_m` long, if the ray
    /// meets the back of a single-sided surface there.
    pub fn back_m(&self, origin: Vec3, direction: Vec3, reach_m: f32) -> Option<f32> {
        let direction = direction.as_dvec3().try_normalize()?;
        let ray = (origin.as_dvec3(), direction);
        let (placed, hit) = self.nearest(ray, f64::from(reach_m), |_| Sides::Both)?;
        placed
            .shows_back(self.shapes[placed.mesh].as_ref()?, hit, direction)
            .then_some(hit.distance as f32)
    }

    /// Whether a point is inside something solid: of 14 rays in all directions, at least 11 hit the
    /// back of a single-sided surface, or at least 8 if all hit something (in a thing on a ground,
    /// rays downwards hit the ground's front).
    pub fn is_inside(&self, at: Vec3) -> bool {
        let steps = [-1, 0, 1];
        let all = steps.iter().flat_map(|x| steps.iter().map(move |y| (x, y)));
        let all = all.flat_map(|(x, y)| steps.iter().map(move |z| IVec3::new(*x, *y, *z)));
        // The directions to the faces and the corners of a cube.
        let around = all.filter(|way| matches!(way.length_squared(), 1 | 3)).map(IVec3::as_dvec3);
        // Slightly skewed, so that no ray runs along a wall.
        let skew = DVec3::new(0.0131, 0.0271, 0.0193);
        let meets_back = |way: DVec3| {
            let (origin, direction) = (at.as_dvec3(), (way + skew).normalize());
            let (placed, hit) =
                self.nearest((origin, direction), f64::INFINITY, |_| Sides::Both)?;
            Some(placed.shows_back(self.shapes[placed.mesh].as_ref()?, hit, direction))
        };
        let met: Vec<bool> = around.filter_map(meets_back).collect();
        let backs = met.iter().filter(|is_back| **is_back).count();
        backs >= 11 || (met.len() == 14 && backs >= 8)
    }

    /// The first surface on a ray of at most this length; `sides` gives the sides of an instance
    /// that rays hit.
    fn nearest(
        &self,
        (origin, direction): (DVec3, DVec3),
        reach: f64,
        sides: impl Fn(&PlacedShape) -> Sides,
    ) -> Option<(&PlacedShape, Hit)> {
        let mut nearest: Option<(&PlacedShape, Hit)> = None;
        for placed in &self.placed {
            let Some(shape) = &self.shapes[placed.mesh] else { continue };
            // The local direction is not normalised, so that distances are in world units.
            let local = (
                placed.local_from_world.transform_point3(origin),
                placed.local_from_world.transform_vector3(direction),
            );
            let limit = nearest.map_or(reach, |(_, hit)| hit.distance);
            if let Some(hit) = shape.nearest(local, sides(placed), limit) {
                nearest = Some((placed, hit));
            }
        }
        nearest
    }
}

impl PlacedShape {
    /// The unit normal of the front of the hit triangle, in the world.
    fn front_of(&self, shape: &Shape, hit: Hit) -> DVec3 {
        let corners = shape
            .corners(hit.triangle)
            .map(|corner| self.world_from_local.as_dmat4().transform_point3(corner));
        let [a, b, c] = corners;
        (b - a).cross(c - a).normalize_or_zero()
    }

    /// Whether a ray meets the back of a single-sided surface.
    fn shows_back(&self, shape: &Shape, hit: Hit, direction: DVec3) -> bool {
        self.sides != Sides::Both && self.front_of(shape, hit).dot(direction) > 0.0
    }

    /// Converts a hit to world space.
    fn tell(&self, shape: &Shape, hit: Hit, (origin, direction): (DVec3, DVec3)) -> Pick {
        let front = self.front_of(shape, hit);
        let is_front = front.dot(direction) <= 0.0;
        let towards = |normal: DVec3| if is_front { normal } else { -normal };
        // By the inverse transpose, with the determinant's sign, as in the renderer.
        let normal_from_local =
            Mat3::from_mat4(self.world_from_local).as_dmat3().inverse().transpose();
        let smooth = normal_from_local * shape.normal(hit).as_dvec3();
        Pick {
            instance: self.instance,
            triangle: hit.triangle,
            position: (origin + hit.distance * direction).as_vec3(),
            normal: towards(front).as_vec3(),
            shading_normal: towards(smooth.try_normalize().unwrap_or(front)).as_vec3(),
            distance_m: hit.distance as f32,
        }
    }
}
