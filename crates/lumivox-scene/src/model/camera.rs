//! Cameras.

use glam::{Mat4, UVec2, Vec2, Vec3};

/// A perspective camera in world space, without a far plane (renderers use reversed, infinite
/// depth or derive one from the scene's bounds).
#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    /// A name for lists and messages.
    pub name: String,
    /// The position of the eye, in metres.
    pub position: Vec3,
    /// Unit vector along the line of sight. Default: -z.
    pub forward: Vec3,
    /// Unit vector towards the top of the picture; need not be orthogonal to `forward`, but must
    /// not be parallel to it. Default: +y.
    pub up: Vec3,
    /// The angle between the bottom and the top of the picture in radians, above 0 and below pi.
    /// Default: 45 degrees. Higher sees more and distorts more.
    pub vertical_fov_rad: f32,
    /// Distance of the near plane in metres, above 0. Default: 0.01. Lower shows closer things and
    /// costs depth precision.
    pub near_m: f32,
}

impl Default for Camera {
    fn default() -> Self {
        Self {
            name: "camera".to_owned(),
            position: Vec3::ZERO,
            forward: Vec3::NEG_Z,
            up: Vec3::Y,
            vertical_fov_rad: std::f32::consts::FRAC_PI_4,
            near_m: 0.01,
        }
    }
}

impl Camera {
    /// A camera at `position` that looks at `target`, upright (+y at the top, or -z if the line of
    /// sight is vertical), with a vertical field of view in radians. If the two points coincide it
    /// looks along -z.
    #[must_use]
    pub fn look_at(position: Vec3, target: Vec3, vertical_fov_rad: f32) -> Self {
        let forward = (target - position).normalize_or(Vec3::NEG_Z);
        // Within about 0.08 degrees of the vertical, +y no longer fixes the roll in f32.
        let up = if forward.y.abs() > 0.999_999 { Vec3::NEG_Z } else { Vec3::Y };
        Self { position, forward, up, vertical_fov_rad, ..Self::default() }
    }

    /// The camera's own axes in the world: right in x, top in y, backwards in z (glTF 2.0, section
    /// 3.10.2), the eye in the translation. Orthonormal.
    pub fn world_from_camera(&self) -> Mat4 {
        let backward = -self.forward.normalize_or(Vec3::NEG_Z);
        let right = self.up.cross(backward).try_normalize();
        // If `up` is along the line of sight, any orthogonal vector will do.
        let right = right.unwrap_or_else(|| backward.any_orthonormal_vector());
        let up = backward.cross(right);
        Mat4::from_cols(
            right.extend(0.0),
            up.extend(0.0),
            backward.extend(0.0),
            self.position.extend(1.0),
        )
    }

    /// The ray through a place in a picture of `size`, in pixels from its upper left corner (the
    /// middle of the first pixel is at 0.5, 0.5): the eye, and a unit vector.
    pub fn ray(&self, pixel: Vec2, size: UVec2) -> (Vec3, Vec3) {
        let size = size.as_vec2();
        let half_height = (0.5 * self.vertical_fov_rad).tan();
        let from_middle = (2.0 * pixel - size) / size.y * half_height;
        let direction = Vec3::new(from_middle.x, -from_middle.y, -1.0).normalize();
        (self.position, self.world_from_camera().transform_vector3(direction))
    }

    /// The view matrix: the inverse of [`Camera::world_from_camera`].
    pub fn camera_from_world(&self) -> Mat4 {
        self.world_from_camera().inverse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_view_puts_the_target_on_the_negative_z_axis() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(-1.0, 0.5, -2.0), 0.8);
        let seen = camera.camera_from_world().transform_point3(Vec3::new(-1.0, 0.5, -2.0));
        assert!(seen.truncate().length() < 1e-5, "{seen}");
        assert!(seen.z < 0.0);
        let above = camera.camera_from_world().transform_vector3(Vec3::Y);
        assert!(above.y > 0.5, "{above}");
    }

    #[test]
    fn rays_go_through_the_picture_from_the_upper_left() {
        let camera = Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::new(1.0, 2.0, -4.0), 1.2);
        let size = UVec2::new(300, 100);
        let (eye, middle) = camera.ray(Vec2::new(150.0, 50.0), size);
        assert_eq!(eye, camera.position);
        assert!(middle.abs_diff_eq(camera.forward, 1e-6), "{middle}");
        let (_, top) = camera.ray(Vec2::new(150.0, 0.0), size);
        assert!((top.angle_between(middle) - 0.6).abs() < 1e-5 && top.y > 0.0);
        let (_, corner) = camera.ray(Vec2::ZERO, size);
        assert!((corner.x / corner.y + 3.0).abs() < 1e-5, "{corner}");
        assert!((corner.length() - 1.0).abs() < 1e-6);
    }

    #[test]
    fn looking_straight_down_still_has_axes() {
        for target in [Vec3::NEG_Y, Vec3::Y] {
            let camera = Camera::look_at(Vec3::ZERO, target, 0.8);
            let m = camera.world_from_camera();
            assert!((m.determinant() - 1.0).abs() < 1e-5);
            assert!(m.y_axis.truncate().abs_diff_eq(Vec3::NEG_Z, 1e-6), "{m}");
        }
    }
}
