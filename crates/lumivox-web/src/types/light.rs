//! Lights.

use glam::Vec3;
use lumivox_scene::Attenuation;
use serde::{Deserialize, Serialize};
use tsify::Tsify;

use crate::error::WebError;

/// The kinds of light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize, Tsify)]
#[serde(rename_all = "kebab-case")]
pub enum LightKind {
    /// Parallel light, such as the sun's; its intensity is in lux.
    Directional,
    /// Light in all directions from a point; its intensity is in candela.
    Point,
    /// Light in a cone from a point; its intensity is in candela.
    Spot,
}

/// A light. Its source is invisible. Properties that its kind does not use are ignored.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, Tsify)]
#[serde(default, deny_unknown_fields)]
pub struct Light {
    /// The name in lists and messages. Default: `"light"`.
    #[tsify(optional)]
    pub name: String,
    /// The kind. Default: `"point"`.
    #[tsify(optional)]
    pub kind: LightKind,
    /// Linear red, green and blue, at least 0. Default: white.
    #[tsify(optional, type = "[number, number, number]")]
    pub color: Vec3,
    /// Intensity in candela; of a directional light illuminance in lux. At least 0. Default: 100.
    #[tsify(optional)]
    pub intensity: f32,
    /// The position in metres. Default: the origin.
    #[tsify(optional, type = "[number, number, number]")]
    pub position: Vec3,
    /// The direction in which the light travels. Default: down.
    #[tsify(optional, type = "[number, number, number]")]
    pub direction: Vec3,
    /// The radius of the source in metres, for soft shadows. Default: 0.
    #[tsify(optional)]
    pub radius_m: f32,
    /// Half the angular diameter of a directional light, in degrees. Default: 0; the sun has 0.27.
    #[tsify(optional)]
    pub angular_radius_deg: f32,
    /// The distance in metres beyond which it may be cut off; `null`, the default, means never.
    #[tsify(optional, type = "number | null")]
    pub range_m: Option<f32>,
    /// For a spot, the angle from its axis at which its light begins to fall off, in degrees.
    /// Default: 0.
    #[tsify(optional)]
    pub inner_cone_deg: f32,
    /// The angle at which the light of a spot ends, in degrees, at most 90. Default: 45.
    #[tsify(optional)]
    pub outer_cone_deg: f32,
}

impl Default for Light {
    fn default() -> Self {
        Self {
            name: "light".to_owned(),
            kind: LightKind::Point,
            color: Vec3::ONE,
            intensity: 100.0,
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            radius_m: 0.0,
            angular_radius_deg: 0.0,
            range_m: None,
            inner_cone_deg: 0.0,
            outer_cone_deg: 45.0,
        }
    }
}

impl From<&lumivox_scene::Light> for Light {
    fn from(light: &lumivox_scene::Light) -> Self {
        let common = Self {
            name: light.name.clone(),
            color: light.color,
            position: light.position,
            direction: light.direction,
            radius_m: light.radius_m,
            ..Self::default()
        };
        match light.kind {
            lumivox_scene::LightKind::Directional { illuminance_lux, angular_radius_rad } => Self {
                kind: LightKind::Directional,
                intensity: illuminance_lux,
                angular_radius_deg: angular_radius_rad.to_degrees(),
                ..common
            },
            lumivox_scene::LightKind::Point { intensity_cd, range_m } => {
                Self { kind: LightKind::Point, intensity: intensity_cd, range_m, ..common }
            }
            lumivox_scene::LightKind::Spot {
                intensity_cd,
                range_m,
                inner_angle_rad,
                outer_angle_rad,
            } => Self {
                kind: LightKind::Spot,
                intensity: intensity_cd,
                range_m,
                inner_cone_deg: inner_angle_rad.to_degrees(),
                outer_cone_deg: outer_angle_rad.to_degrees(),
                ..common
            },
        }
    }
}

impl Light {
    /// Converts to the scene's light, checked. Only the look of VXCT uses `attenuation`.
    ///
    /// # Errors
    /// When a number is out of range.
    pub fn to_scene(
        &self,
        attenuation: Option<Attenuation>,
    ) -> Result<lumivox_scene::Light, WebError> {
        let name = &self.name;
        let at_least_0 = |what: &str, number: f32| {
            if number >= 0.0 && number.is_finite() {
                return Ok(number);
            }
            Err(WebError::value(format!(
                "{what} of the light \"{name}\" is {number}, but must be at least 0"
            )))
        };
        for channel in self.color.to_array() {
            at_least_0("color", channel)?;
        }
        if !self.position.is_finite() {
            return Err(WebError::value(format!(
                "position of the light \"{name}\" must be finite numbers"
            )));
        }
        let direction = self.direction.try_normalize().ok_or_else(|| {
            WebError::value(format!("direction of the light \"{name}\" must not be zero"))
        })?;
        let intensity = at_least_0("intensity", self.intensity)?;
        if let Some(range_m) = self.range_m {
            at_least_0("range_m", range_m)?;
        }
        let (inner, outer) = (self.inner_cone_deg, self.outer_cone_deg);
        if !(0.0 <= inner && inner <= outer && 0.0 < outer && outer <= 90.0) {
            return Err(WebError::value(format!(
                "the cone of the light \"{name}\" is from {inner} to {outer} degrees, but must be from at least 0 to \
                 at most 90, the outer angle not below the inner one"
            )));
        }
        let kind = match self.kind {
            LightKind::Directional => lumivox_scene::LightKind::Directional {
                illuminance_lux: intensity,
                angular_radius_rad: at_least_0("angular_radius_deg", self.angular_radius_deg)?
                    .to_radians(),
            },
            LightKind::Point => {
                lumivox_scene::LightKind::Point { intensity_cd: intensity, range_m: self.range_m }
            }
            LightKind::Spot => lumivox_scene::LightKind::Spot {
                intensity_cd: intensity,
                range_m: self.range_m,
                inner_angle_rad: inner.to_radians(),
                outer_angle_rad: outer.to_radians(),
            },
        };
        Ok(lumivox_scene::Light {
            name: name.clone(),
            kind,
            color: self.color,
            position: self.position,
            direction,
            radius_m: at_least_0("radius_m", self.radius_m)?,
            attenuation,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_come_back_as_they_went() {
        for name in lumivox_scene::builtin::names() {
            for light in &lumivox_scene::builtin::scene(name).unwrap().lights {
                let again = Light::from(light).to_scene(light.attenuation).unwrap();
                assert!(again.direction.distance(light.direction) < 1e-6);
                let again = lumivox_scene::Light { direction: light.direction, ..again };
                assert_eq!(Light::from(&again), Light::from(light));
            }
        }
    }

    #[test]
    fn what_a_light_cannot_be_is_told() {
        let message = |light: Light| light.to_scene(None).unwrap_err().message;
        let dark = Light { intensity: -1.0, ..Light::default() };
        assert!(message(dark).contains("intensity of the light \"light\" is -1"));
        let nowhere = Light { direction: Vec3::ZERO, ..Light::default() };
        assert!(message(nowhere).contains("direction"));
        let inside_out = Light { inner_cone_deg: 50.0, ..Light::default() };
        assert!(message(inside_out).contains("from 50 to 45 degrees"));
    }
}
