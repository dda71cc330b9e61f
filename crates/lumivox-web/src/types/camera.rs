//! Cameras.

use glam::Vec3;
use serde::{Deserialize, Serialize};
use tsify::Tsify;

use crate::error::WebError;

/// A camera. Lengths are in metres, y is up.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(deny_unknown_fields)]
pub struct Camera {
    /// The name in lists and messages.
    #[serde(default)]
    #[tsify(optional)]
    pub name: String,
    /// The position of the eye.
    #[tsify(type = "[number, number, number]")]
    pub position: Vec3,
    /// The point at the centre of the picture; its distance has no effect.
    #[tsify(type = "[number, number, number]")]
    pub target: Vec3,
    /// The upward direction of the picture, not along the line of sight. Default: `[0, 1, 0]`.
    #[serde(default = "upright")]
    #[tsify(optional, type = "[number, number, number]")]
    pub up: Vec3,
    /// The vertical field of view in degrees, above 0 and below 180. Default: 45.
    #[serde(default = "usual_fov")]
    #[tsify(optional)]
    pub vertical_fov_deg: f32,
}

fn upright() -> Vec3 {
    Vec3::Y
}

fn usual_fov() -> f32 {
    45.0
}

impl From<&lumivox_scene::Camera> for Camera {
    fn from(camera: &lumivox_scene::Camera) -> Self {
        Self {
            name: camera.name.clone(),
            position: camera.position,
            target: camera.position + camera.forward,
            up: camera.up,
            vertical_fov_deg: camera.vertical_fov_rad.to_degrees(),
        }
    }
}

impl Camera {
    /// Converts to the scene's camera; the near plane is that of `present`.
    ///
    /// # Errors
    /// When the camera has no direction, or the field of view is out of range.
    pub fn to_scene(
        &self,
        present: &lumivox_scene::Camera,
    ) -> Result<lumivox_scene::Camera, WebError> {
        let fail = |what: &str| Err(WebError::value(format!("the camera's {what}")));
        if ![self.position, self.target, self.up].iter().all(|v| v.is_finite()) {
            return fail("position, target and up must be finite numbers");
        }
        let Some(forward) = (self.target - self.position).try_normalize() else {
            return fail("target is its position; move one of them");
        };
        let Some(up) = self.up.try_normalize().filter(|up| up.cross(forward).length() > 1e-6)
        else {
            return fail("up is along its line of sight; turn one of them");
        };
        if !(self.vertical_fov_deg > 0.0 && self.vertical_fov_deg < 180.0) {
            return fail("vertical_fov_deg must be above 0 and below 180");
        }
        Ok(lumivox_scene::Camera {
            name: self.name.clone(),
            position: self.position,
            forward,
            up,
            vertical_fov_rad: self.vertical_fov_deg.to_radians(),
            near_m: present.near_m,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cameras_round_trip_through_javascript() {
        let camera = lumivox_scene::Camera::look_at(Vec3::new(1.0, 2.0, 3.0), Vec3::ZERO, 0.7);
        let again = Camera::from(&camera).to_scene(&camera).unwrap();
        assert!(again.forward.distance(camera.forward) < 1e-6);
        assert!((again.vertical_fov_rad - camera.vertical_fov_rad).abs() < 1e-6);
        let of = |change: fn(&mut Camera)| {
            let mut changed = Camera::from(&camera);
            change(&mut changed);
            changed.to_scene(&camera).unwrap_err().message
        };
        assert!(of(|camera| camera.target = camera.position).contains("target"));
        assert!(of(|camera| camera.up = camera.target - camera.position).contains("up"));
        assert!(of(|camera| camera.vertical_fov_deg = 180.0).contains("below 180"));
        assert!(of(|camera| camera.position.x = f32::NAN).contains("finite"));
    }
}
