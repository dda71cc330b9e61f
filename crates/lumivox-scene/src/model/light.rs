//! Lights and the surroundings.

use std::f32::consts::FRAC_PI_4;
use std::sync::Arc;

use glam::Vec3;

use super::light_fields::{LIGHT_FIELDS, LightField};

/// A light for analytic direct lighting. It is invisible: a lamp that should be seen needs an
/// emissive surface, too. [`LIGHT_FIELDS`] lists the fields of each kind, with ranges; the others
/// are ignored.
#[derive(Clone, Debug, PartialEq)]
pub struct Light {
    /// A name for lists and messages.
    pub name: String,
    /// The kind of light. Default: a point light.
    pub kind: LightKind,
    /// Luminous intensity in candela, for a spot light inside its inner cone; for a directional
    /// light, illuminance in lux of a surface that faces it (noon sun: about 100 000). Default: 1.
    pub intensity: f32,
    /// Linear RGB factor of the intensity. Default: white (1, 1, 1).
    pub color: Vec3,
    /// World position in metres. Default: the origin.
    pub position: Vec3,
    /// Unit vector along which the light travels. Default: -y.
    pub direction: Vec3,
    /// Radius of the luminous sphere in metres, only for soft shadows; the intensity stays the
    /// same. Default: 0, a point with hard shadows.
    pub radius_m: f32,
    /// Distance in metres beyond which the light may be cut off. Default: `None`, which is
    /// unlimited, the physical choice.
    pub range_m: Option<f32>,
    /// Angle from the axis of a spot light at which its intensity reaches zero, in radians.
    /// Default: pi/4.
    pub outer_angle_rad: f32,
    /// Angle from the axis at which the intensity begins to fall, in radians. Default: 0.
    pub inner_angle_rad: f32,
    /// Half the angular diameter of a directional light, in radians; the sun has 0.00465. Default:
    /// 0, hard shadows.
    pub angular_radius_rad: f32,
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
            kind: LightKind::Point,
            intensity: 1.0,
            color: Vec3::ONE,
            position: Vec3::ZERO,
            direction: Vec3::NEG_Y,
            radius_m: 0.0,
            range_m: None,
            outer_angle_rad: FRAC_PI_4,
            inner_angle_rad: 0.0,
            angular_radius_rad: 0.0,
            attenuation: None,
        }
    }
}

impl Light {
    /// A new light of a kind, to be placed by the caller: a lamp of 100 cd or a noon sun from
    /// above.
    pub fn typical(kind: LightKind) -> Self {
        let lamp = Self { kind, intensity: 100.0, ..Self::default() };
        match kind {
            LightKind::Directional => {
                Self { intensity: 100_000.0, angular_radius_rad: 0.004_65, ..lamp }
            }
            LightKind::Point => lamp,
            LightKind::Spot => Self {
                inner_angle_rad: 20.0_f32.to_radians(),
                outer_angle_rad: 30.0_f32.to_radians(),
                ..lamp
            },
        }
    }

    /// The inner and outer angle of a spot light's cone, in radians; `None` for other lights.
    pub fn cone_rad(&self) -> Option<[f32; 2]> {
        (self.kind == LightKind::Spot).then_some([self.inner_angle_rad, self.outer_angle_rad])
    }

    /// Illuminance in lux, without the colour, of a surface that faces the light at a distance.
    pub fn illuminance_at(&self, distance_m: f32) -> f32 {
        if self.kind.is_parallel() { self.intensity } else { self.intensity / distance_m.powi(2) }
    }
}

/// The kinds of light, which are those of the glTF extension `KHR_lights_punctual`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum LightKind {
    /// Light in all directions from a point.
    #[default]
    Point,
    /// Light in a cone from a point.
    Spot,
    /// Parallel light from far away, such as the sun.
    Directional,
}

impl LightKind {
    /// All kinds.
    pub const ALL: [Self; 3] = [Self::Point, Self::Spot, Self::Directional];

    /// The kind's name in files and records.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Point => "point",
            Self::Spot => "spot",
            Self::Directional => "directional",
        }
    }

    /// The kind's name in the console and in panels.
    pub const fn word(self) -> &'static str {
        if self.is_parallel() { "sun" } else { self.name() }
    }

    /// A sentence about the kind, without a full stop.
    pub const fn summary(self) -> &'static str {
        match self {
            Self::Point => "A lamp that shines in all directions",
            Self::Spot => "A lamp that shines into a cone",
            Self::Directional => "Parallel light from far away",
        }
    }

    /// The unit of [`Light::intensity`].
    pub const fn unit(self) -> &'static str {
        if self.is_parallel() { "lux" } else { "cd" }
    }

    /// `true` if its light is parallel, from no position.
    pub const fn is_parallel(self) -> bool {
        matches!(self, Self::Directional)
    }

    /// `true` if lights of this kind have the field.
    pub fn has(self, field: &str) -> bool {
        self.fields().any(|own| own.name == field)
    }

    /// The fields of lights of this kind.
    pub fn fields(self) -> impl Iterator<Item = &'static LightField> {
        LIGHT_FIELDS.iter().filter(move |field| field.kinds.contains(&self))
    }
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
