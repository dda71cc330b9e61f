//! Lights and the surroundings.

use std::sync::Arc;

use glam::Vec3;

/// A light for analytic direct lighting. It is invisible: a lamp that should be seen needs an
/// emissive surface, too.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// A name for lists and messages.
    pub name: String,
    /// The kind and strength of the light.
    pub kind: LightKind,
    /// Linear RGB factor of the intensity or illuminance. Default: white (1, 1, 1).
    pub color: Vec3,
    /// World position in metres; ignored for a directional light.
    pub position: Vec3,
    /// Unit vector along which the light travels; ignored for a point light. Default: -y.
    pub direction: Vec3,
    /// Radius of the luminous sphere in metres, only for soft shadows; the intensity stays the
    /// same. Default: 0, a point with hard shadows. The kind of a directional light has an angular
    /// radius instead.
    pub radius_m: f32,
    /// The fall-off in looks without physical units. Default: none, which means the inverse square.
    /// Physical renderers ignore it.
    pub attenuation: Option<Attenuation>,
}

/// The fall-off of a light as in the fixed pipelines of graphics hardware (Segal and Akeley 1992,
/// "The OpenGL graphics system", section 2.13.1): at a distance of d metres, the share `1 /
/// (constant + linear d + quadratic d²)` of the light arrives.
///
/// Physical renderers use the inverse square of the intensity instead; the `vxct` look uses this.
/// Both agree at a metre: if [`Attenuation::at`] 1 m is a, the intensity is pi a candela, so that a
/// white diffuse surface that faces the light there has a radiance of a cd/m².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Attenuation {
    /// The part that does not depend on the distance, at least 0. Default: 1.
    pub constant: f32,
    /// The part that grows with the distance, 1/m, at least 0. Default: 0.15.
    pub linear: f32,
    /// The part that grows with the square of the distance, 1/m², at least 0. Default: 0.45.
    pub quadratic: f32,
}

impl Default for Attenuation {
    /// VXCT's default.
    fn default() -> Self {
        Self { constant: 1.0, linear: 0.15, quadratic: 0.45 }
    }
}

impl Attenuation {
    /// The share of the light that arrives at a distance in metres.
    pub fn at(&self, distance_m: f32) -> f32 {
        1.0 / (self.constant + distance_m * (self.linear + distance_m * self.quadratic))
    }
}

impl Default for Light {
    /// A white point light of 1 cd at the origin.
    fn default() -> Self {
        Self {
            name: "light".to_owned(),
            kind: LightKind::Point { intensity_cd: 1.0, range_m: None },
            color: Vec3::ONE,
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            radius_m: 0.0,
            attenuation: None,
        }
    }
}

/// The kinds of light of the glTF extension `KHR_lights_punctual`, in its units.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightKind {
    /// Parallel light from far away, such as the sun.
    Directional {
        /// Illuminance of a surface that faces the light, in lux; the sun at noon has about
        /// 100 000.
        illuminance_lux: f32,
        /// Half the angular diameter of the source, in radians; the sun has 0.00465. 0 gives hard
        /// shadows.
        angular_radius_rad: f32,
    },
    /// Light in all directions from a point.
    Point {
        /// Luminous intensity in candela, the same in every direction.
        intensity_cd: f32,
        /// Distance in metres beyond which the light may be cut off; `None` is unlimited, the
        /// physical choice.
        range_m: Option<f32>,
    },
    /// Light in a cone from a point.
    Spot {
        /// Luminous intensity in candela inside the inner cone.
        intensity_cd: f32,
        /// Distance in metres beyond which the light may be cut off; `None` is unlimited.
        range_m: Option<f32>,
        /// Angle from the axis at which the intensity begins to fall, in radians, at least 0.
        inner_angle_rad: f32,
        /// Angle from the axis at which it reaches zero, in radians, at least the inner angle and
        /// at most pi/2.
        outer_angle_rad: f32,
    },
}

/// The light from outside the scene, seen by rays that leave it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Environment {
    /// Radiance in cd/m², the same in every direction; with a map, the factor of its texels.
    /// Default: zero, black surroundings; a clear blue sky has about 3000.
    pub radiance: Vec3,
    /// A picture of the surroundings. Default: none.
    pub map: Option<Arc<EnvironmentMap>>,
    /// Rotation of the map about the y axis, in radians, counter-clockwise seen from above.
    /// Default: 0.
    pub rotation_rad: f32,
}

/// An environment of the unscaled, unrotated map.
impl From<Arc<EnvironmentMap>> for Environment {
    fn from(map: Arc<EnvironmentMap>) -> Self {
        Self { radiance: Vec3::ONE, map: Some(map), rotation_rad: 0.0 }
    }
}

/// A picture of all directions: equirectangular, that is, longitude by latitude.
///
/// The texel in the middle of the picture is in the direction -z; from there columns go to the
/// right (+x), rows go down from +y at the top edge to -y at the bottom edge.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EnvironmentMap {
    /// A name for lists and messages.
    pub name: String,
    /// Width in texels, at least 1; 360 degrees.
    pub width: u32,
    /// Height in texels, at least 1; 180 degrees.
    pub height: u32,
    /// Linear RGB, at least 0, row by row from the top; `width * height` texels. Radiance in cd/m²
    /// if [`Environment::radiance`] is 1.
    pub rgb: Vec<[f32; 3]>,
    /// Sentences for the user on repairs and assumptions while loading; add them to
    /// [`LoadNotes::warnings`](super::LoadNotes) of the scene that uses the map.
    pub warnings: Vec<String>,
}
