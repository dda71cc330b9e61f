//! The motion of the points that a picture shows since the previous picture, in pixels.
//!
//! A pixel's point is the one that the ray through its middle hits. Its place in the earlier scene
//! is computed from the instance's transforms or, if an animation deforms the mesh, from the
//! corners of the triangle. Both places are projected by the cameras of their pictures. Points of
//! the background are infinitely far away.

use glam::{DMat4, DVec2, DVec3, DVec4, UVec2, Vec2};
use lumivox_scene::{Camera, Pick, Picker, Scene};

/// A scene as a camera sees it.
#[derive(Clone, Copy)]
pub struct Shot<'a> {
    pub scene: &'a Scene,
    pub camera: &'a Camera,
}

/// The motion of each pixel, x to the right and y down; NaN where the point was not in front of the
/// earlier camera.
pub fn motion(now: Shot<'_>, before: Shot<'_>, picker: &Picker, size: UVec2) -> Vec<f32> {
    let parts = Parts::new(now.scene, before.scene);
    let eyes = [now.camera, before.camera].map(Eye::new);
    let pixels = (0..size.y).flat_map(|y| (0..size.x).map(move |x| UVec2::new(x, y)));
    let way = |pixel: UVec2| {
        let (origin, direction) = now.camera.ray(pixel.as_vec2() + Vec2::splat(0.5), size);
        let points = match picker.pick(origin, direction) {
            Some(pick) => {
                [pick.position.as_dvec3(), parts.former(&pick)].map(|point| point.extend(1.0))
            }
            None => [direction.as_dvec3().extend(0.0); 2],
        };
        let places = [0, 1].map(|which| eyes[which].project(points[which], size));
        (places[0] - places[1]).as_vec2().to_array()
    };
    pixels.flat_map(way).collect()
}

/// The places of instances in the earlier scene.
struct Parts<'a> {
    now: &'a Scene,
    before: &'a Scene,
    /// How each instance has moved; empty if both scenes are one, or their instances differ.
    moves: Vec<Move>,
}

enum Move {
    /// The instance has not moved.
    None,
    /// The transform from the present world to the earlier one.
    Rigid(DMat4),
    /// The vertices of its mesh moved.
    Deformed,
}

impl<'a> Parts<'a> {
    fn new(now: &'a Scene, before: &'a Scene) -> Self {
        let pairs = || now.instances.iter().zip(&before.instances);
        let is_same = now.instances.len() == before.instances.len()
            && now.meshes.len() == before.meshes.len()
            && pairs().all(|(a, b)| a.mesh == b.mesh);
        if !is_same || std::ptr::eq(now, before) {
            return Self { now, before, moves: Vec::new() };
        }
        let meshes = now.meshes.iter().zip(&before.meshes);
        let deforms: Vec<bool> = meshes.map(|(a, b)| a.positions != b.positions).collect();
        let moves = pairs().map(|(a, b)| {
            if deforms.get(a.mesh).copied().unwrap_or_default() {
                return Move::Deformed;
            }
            if a.world_from_local == b.world_from_local {
                return Move::None;
            }
            Move::Rigid(b.world_from_local.as_dmat4() * a.world_from_local.as_dmat4().inverse())
        });
        Self { now, before, moves: moves.collect() }
    }

    /// The earlier place of a point.
    fn former(&self, pick: &Pick) -> DVec3 {
        let point = pick.position.as_dvec3();
        match self.moves.get(pick.instance) {
            None | Some(Move::None) => point,
            Some(Move::Rigid(before_from_now)) => before_from_now.transform_point3(point),
            Some(Move::Deformed) => self.deformed(pick).unwrap_or(point),
        }
    }

    /// The point with the same barycentric weights in the earlier triangle.
    fn deformed(&self, pick: &Pick) -> Option<DVec3> {
        let corners = |scene: &Scene| -> Option<[DVec3; 3]> {
            let instance = scene.instances.get(pick.instance)?;
            // Both poses have the same vertices; `pick` counts the triangles of the present one.
            let indices = &self.now.meshes.get(instance.mesh)?.indices;
            let triangle = indices.get(3 * pick.triangle..3 * pick.triangle + 3)?;
            let positions = &scene.meshes.get(instance.mesh)?.positions;
            let world_from_local = instance.world_from_local.as_dmat4();
            let mut corners = [DVec3::ZERO; 3];
            for (corner, &index) in corners.iter_mut().zip(triangle) {
                let position = positions.get(index as usize)?.as_dvec3();
                *corner = world_from_local.transform_point3(position);
            }
            Some(corners)
        };
        let ([a, b, c], [d, e, f]) = (corners(self.now)?, corners(self.before)?);
        let normal = (b - a).cross(c - a);
        let point = pick.position.as_dvec3();
        let weight = |from: DVec3, to: DVec3| {
            (to - from).cross(point - from).dot(normal) / normal.length_squared()
        };
        let (of_b, of_c) = (weight(c, a), weight(a, b));
        Some((1.0 - of_b - of_c) * d + of_b * e + of_c * f)
    }
}

/// A camera's projection.
struct Eye {
    camera_from_world: DMat4,
    half_height: f64,
}

impl Eye {
    fn new(camera: &Camera) -> Self {
        let camera_from_world = camera.world_from_camera().as_dmat4().inverse();
        Self { camera_from_world, half_height: (0.5 * f64::from(camera.vertical_fov_rad)).tan() }
    }

    /// The pixel of a point, or of a direction (last component 0); NaN behind the camera.
    fn project(&self, point: DVec4, size: UVec2) -> DVec2 {
        let seen = self.camera_from_world * point;
        if seen.z >= 0.0 {
            return DVec2::NAN;
        }
        let size = size.as_dvec2();
        let from_middle = DVec2::new(seen.x, -seen.y) / (-seen.z * self.half_height);
        0.5 * (size + size.y * from_middle)
    }
}
