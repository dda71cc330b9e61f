//! The handles that move, rotate and scale objects and lights in the picture.

use egui::{Pos2, Rect, pos2};
use glam::{Quat, Vec2, Vec3};
use lumivox_explorer::Placement;
use lumivox_scene::Camera;

/// The mode of the handles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Arrows along the world's axes.
    #[default]
    Move,
    /// Rings about the world's axes.
    Turn,
    /// Boxes along the object's axes, and one in the middle for all three.
    Size,
}

/// A handle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Handle {
    /// The handle along or about x, y or z.
    Axis(usize),
    /// All axes at once.
    Middle,
}

/// The projection of the world into the picture on the screen.
#[derive(Clone, Debug)]
pub struct Projection {
    camera: Camera,
    rect: Rect,
}

/// Steps while Ctrl is held: of moves and scales, as a share of the handles' length or of the
/// scale; of rotations, in degrees.
const SNAP_SHARE: f32 = 0.1;
const SNAP_DEG: f32 = 15.0;
/// Length of the handles, as a share of the picture's height.
const LENGTH_SHARE: f32 = 0.16;
/// Segments of a ring.
const RING_POINTS: usize = 48;
/// Maximum distance of the pointer to a handle, points.
const REACH: f32 = 9.0;

impl Projection {
    /// The projection of a camera whose picture fills a rectangle.
    pub fn new(camera: &Camera, rect: Rect) -> Self {
        Self { camera: camera.clone(), rect }
    }

    /// The position of a world point on the screen; `None` behind the eye.
    pub fn project(&self, point: Vec3) -> Option<Pos2> {
        let seen = self.camera.camera_from_world().transform_point3(point);
        let depth = -seen.z;
        if depth <= self.camera.near_m * 0.5 || !depth.is_finite() {
            return None;
        }
        let half_height = depth * (0.5 * self.camera.vertical_fov_rad).tan();
        let scale = 0.5 * self.rect.height() / half_height;
        let center = self.rect.center();
        Some(pos2(center.x + seen.x * scale, center.y - seen.y * scale))
    }

    /// The ray through a point of the screen: the eye, and a unit vector.
    pub fn ray(&self, at: Pos2) -> (Vec3, Vec3) {
        let half_height = (0.5 * self.camera.vertical_fov_rad).tan();
        let from_middle = (at - self.rect.center()) * (2.0 * half_height / self.rect.height());
        let direction = Vec3::new(from_middle.x, -from_middle.y, -1.0).normalize();
        (self.camera.position, self.camera.world_from_camera().transform_vector3(direction))
    }

    /// World length of handles at a point, m, for a constant size on the screen.
    pub fn handle_length(&self, at: Vec3) -> f32 {
        let depth = (at - self.camera.position).dot(self.camera.forward).max(self.camera.near_m);
        2.0 * depth * (0.5 * self.camera.vertical_fov_rad).tan() * LENGTH_SHARE
    }

    /// A world segment on the screen, clipped at the near plane; `None` if it is all behind.
    pub fn segment(&self, from: Vec3, to: Vec3) -> Option<[Pos2; 2]> {
        let near =
            |p: Vec3| (p - self.camera.position).dot(self.camera.forward) - self.camera.near_m;
        let (a, b) = (near(from), near(to));
        let (from, to) = match (a > 0.0, b > 0.0) {
            (true, true) => (from, to),
            (true, false) => (from, from.lerp(to, a / (a - b))),
            (false, true) => (to.lerp(from, b / (b - a)), to),
            (false, false) => return None,
        };
        Some([self.project(from)?, self.project(to)?])
    }

    /// The distance along a line (`axis` is a unit vector) to the point nearest to the pointer's
    /// ray, m.
    fn along(&self, origin: Vec3, axis: Vec3, at: Pos2) -> Option<f32> {
        let (eye, ray) = self.ray(at);
        let (w, b) = (origin - eye, axis.dot(ray));
        let denominator = 1.0 - b * b;
        // The ray is nearly parallel to the axis.
        if denominator < 1e-4 {
            return None;
        }
        Some((b * ray.dot(w) - axis.dot(w)) / denominator)
    }

    /// The direction from a point to where the pointer's ray meets the plane through it that is
    /// perpendicular to `axis`; `None` if the ray is nearly parallel to the plane.
    fn around(&self, origin: Vec3, axis: Vec3, at: Pos2) -> Option<Vec3> {
        let (eye, ray) = self.ray(at);
        let slope = ray.dot(axis);
        if slope.abs() < 0.02 {
            return None;
        }
        (eye + ray * ((origin - eye).dot(axis) / slope) - origin).try_normalize()
    }
}

/// The unit vector along an axis.
pub fn unit(axis: usize) -> Vec3 {
    [Vec3::X, Vec3::Y, Vec3::Z][axis.min(2)]
}

/// The directions of the handles: the world's axes; the object's axes for sizes.
pub fn axes(mode: Mode, placement: &Placement) -> [Vec3; 3] {
    let turn = if mode == Mode::Size { rotation(placement) } else { Quat::IDENTITY };
    [0, 1, 2].map(|axis| turn * unit(axis))
}

/// The ring about an axis through a point.
pub fn ring(origin: Vec3, axis: Vec3, radius: f32) -> Vec<Vec3> {
    let (u, v) = axis.any_orthonormal_pair();
    let at = |step: usize| {
        let (sin, cos) = (step as f32 * std::f32::consts::TAU / RING_POINTS as f32).sin_cos();
        origin + (u * cos + v * sin) * radius
    };
    (0..=RING_POINTS).map(at).collect()
}

/// The handle under the pointer.
pub fn hit(view: &Projection, mode: Mode, placement: &Placement, at: Pos2) -> Option<Handle> {
    let origin = placement.position;
    let length = view.handle_length(origin);
    let middle = view.project(origin)?;
    if mode == Mode::Size && middle.distance(at) < REACH {
        return Some(Handle::Middle);
    }
    let distance = |axis: usize| {
        let direction = axes(mode, placement)[axis];
        match mode {
            Mode::Turn => {
                let points = ring(origin, direction, length);
                let far = |pair: &[Vec3]| {
                    view.segment(pair[0], pair[1]).map_or(f32::INFINITY, |s| to_segment(at, s))
                };
                points.windows(2).map(far).fold(f32::INFINITY, f32::min)
            }
            Mode::Move | Mode::Size => view
                .segment(origin, origin + direction * length)
                .map_or(f32::INFINITY, |segment| to_segment(at, segment)),
        }
    };
    (0..3)
        .map(|axis| (distance(axis), axis))
        .filter(|(distance, _)| *distance < REACH)
        .min_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, axis)| Handle::Axis(axis))
}

fn to_segment(at: Pos2, [a, b]: [Pos2; 2]) -> f32 {
    let along = b - a;
    let share = if along.length_sq() > 0.0 { (at - a).dot(along) / along.length_sq() } else { 0.0 };
    (at - (a + along * share.clamp(0.0, 1.0))).length()
}

/// A handle that is being dragged.
#[derive(Clone, Debug)]
pub struct Drag {
    /// The mode of the handles.
    pub mode: Mode,
    /// The dragged handle.
    pub handle: Handle,
    start: Placement,
    from: Pos2,
}

impl Drag {
    /// Starts a drag.
    pub fn new(mode: Mode, handle: Handle, start: Placement, from: Pos2) -> Self {
        Self { mode, handle, start, from }
    }

    /// The object's placement with the pointer at `at`; snaps to steps if `snaps`.
    pub fn placement(&self, view: &Projection, at: Pos2, snaps: bool) -> Placement {
        let origin = self.start.position;
        let length = view.handle_length(origin);
        let step =
            |value: f32, step: f32| if snaps { (value / step).round() * step } else { value };
        match (self.mode, self.handle) {
            (Mode::Move, Handle::Axis(axis)) => {
                let axis = unit(axis);
                let moved = view.along(origin, axis, at).zip(view.along(origin, axis, self.from));
                let way = moved.map_or(0.0, |(now, then)| now - then);
                // The step is the power of ten that is nearest to a tenth of the handles' length.
                let round = 10.0_f32.powf((length * SNAP_SHARE).log10().round());
                Placement { position: origin + axis * step(way, round), ..self.start }
            }
            (Mode::Turn, Handle::Axis(axis)) => {
                let axis = unit(axis);
                let ends = view.around(origin, axis, self.from).zip(view.around(origin, axis, at));
                let angle =
                    ends.map_or(0.0, |(then, now)| axis.dot(then.cross(now)).atan2(then.dot(now)));
                let angle = step(angle.to_degrees(), SNAP_DEG).to_radians();
                let turned = Quat::from_axis_angle(axis, angle) * rotation(&self.start);
                let (x, y, z) = turned.to_euler(glam::EulerRot::XYZ);
                Placement { rotation_deg: Vec3::new(x, y, z).map(f32::to_degrees), ..self.start }
            }
            (Mode::Size, Handle::Axis(axis)) => {
                let direction = axes(Mode::Size, &self.start)[axis.min(2)];
                let ends = view
                    .along(origin, direction, at)
                    .zip(view.along(origin, direction, self.from))
                    .filter(|(_, then)| then.abs() > 1e-6);
                let factor = ends.map_or(1.0, |(now, then)| now / then);
                let factor = step(factor, SNAP_SHARE).max(0.01);
                let mut scale = self.start.scale;
                scale[axis.min(2)] *= factor;
                Placement { scale, ..self.start }
            }
            (Mode::Size, Handle::Middle) => {
                let way = Vec2::new(at.x - self.from.x, self.from.y - at.y).dot(Vec2::ONE);
                let factor = step((way * 0.01).exp(), SNAP_SHARE).max(0.01);
                Placement { scale: self.start.scale * factor, ..self.start }
            }
            (Mode::Move | Mode::Turn, Handle::Middle) => self.start,
        }
    }
}

fn rotation(placement: &Placement) -> Quat {
    let [x, y, z] = placement.rotation_deg.map(f32::to_radians).to_array();
    Quat::from_euler(glam::EulerRot::XYZ, x, y, z)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn view() -> Projection {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 6.0), Vec3::new(0.0, 0.5, 0.0), 0.9);
        Projection::new(&camera, Rect::from_min_size(pos2(100.0, 50.0), egui::vec2(400.0, 300.0)))
    }

    fn placement() -> Placement {
        Placement { position: Vec3::new(0.2, 0.4, 0.1), rotation_deg: Vec3::ZERO, scale: Vec3::ONE }
    }

    #[test]
    fn the_ray_of_a_projected_point_hits_it() {
        let view = view();
        let point = Vec3::new(0.3, -0.2, 1.5);
        let (eye, ray) = view.ray(view.project(point).unwrap());
        assert!((point - eye).normalize().abs_diff_eq(ray, 1e-4));
        assert!(view.project(Vec3::new(1.0, 2.0, 8.0)).is_none());
        // A segment from behind the eye is cut off.
        assert!(view.segment(Vec3::new(1.0, 2.0, 9.0), Vec3::ZERO).is_some());
        assert!(view.segment(Vec3::new(1.0, 2.0, 9.0), Vec3::new(1.0, 2.0, 8.0)).is_none());
    }

    #[test]
    fn an_arrow_moves_along_its_axis_as_far_as_the_pointer() {
        let view = view();
        for axis in 0..3 {
            let from = view.project(placement().position + unit(axis) * 0.3).unwrap();
            let to = view.project(placement().position + unit(axis) * 0.8).unwrap();
            assert_eq!(hit(&view, Mode::Move, &placement(), from), Some(Handle::Axis(axis)));
            let drag = Drag::new(Mode::Move, Handle::Axis(axis), placement(), from);
            let moved = drag.placement(&view, to, false).position - placement().position;
            assert!(moved.abs_diff_eq(unit(axis) * 0.5, 1e-3), "{moved}");
            assert_eq!(drag.placement(&view, from, false).position, placement().position);
        }
    }

    #[test]
    fn a_ring_rotates_by_the_angle_of_the_drag() {
        let view = view();
        let at = |deg: f32| {
            let (sin, cos) = deg.to_radians().sin_cos();
            view.project(placement().position + Vec3::new(cos, 0.0, -sin) * 0.5).unwrap()
        };
        let drag = Drag::new(Mode::Turn, Handle::Axis(1), placement(), at(10.0));
        let turned = drag.placement(&view, at(50.0), false).rotation_deg;
        assert!(turned.abs_diff_eq(Vec3::new(0.0, 40.0, 0.0), 0.1), "{turned}");
        let snapped = drag.placement(&view, at(50.0), true).rotation_deg;
        assert!(snapped.abs_diff_eq(Vec3::new(0.0, 45.0, 0.0), 1e-3), "{snapped}");
    }

    #[test]
    fn boxes_scale_along_the_objects_axes() {
        let view = view();
        let turned = Placement { rotation_deg: Vec3::new(0.0, 90.0, 0.0), ..placement() };
        let direction = axes(Mode::Size, &turned)[2];
        assert!(direction.abs_diff_eq(Vec3::X, 1e-5), "{direction}");
        let from = view.project(turned.position + direction * 0.4).unwrap();
        let to = view.project(turned.position + direction * 0.8).unwrap();
        let drag = Drag::new(Mode::Size, Handle::Axis(2), turned, from);
        let scale = drag.placement(&view, to, false).scale;
        assert!(scale.abs_diff_eq(Vec3::new(1.0, 1.0, 2.0), 1e-2), "{scale}");
        let middle = Drag::new(Mode::Size, Handle::Middle, turned, from);
        let grown = middle.placement(&view, from + egui::vec2(50.0, 0.0), false).scale;
        assert!(grown.x > 1.2 && grown.x == grown.y && grown.y == grown.z, "{grown}");
        // Scales stay positive.
        assert!(drag.placement(&view, from - (to - from) * 9.0, false).scale.min_element() > 0.0);
    }
}
