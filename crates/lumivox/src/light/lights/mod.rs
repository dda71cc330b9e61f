//! Lights and the environment: the caller's, in radiometric (or photometric) units, and the GPU's.
//!
//! The whole library uses one unit of radiance: if lights are in lux and candela, radiance is in
//! cd/m². The volumes store half floats (6e-5 to 65504; brighter values are clamped), so give very
//! bright scenes in a larger unit.

mod bound;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use crate::gpu::{Buffer, TextureView, upload};

pub(crate) use bound::lights_layout;
pub use bound::{Lights, MappedLight, ShadowSource};

/// Values of `Light::kind` in the shaders.
pub(super) const LIGHT_DIRECTIONAL: u32 = 0;
pub(super) const LIGHT_POINT: u32 = 1;
pub(super) const LIGHT_SPOT: u32 = 2;
pub(super) const LIGHT_ENVIRONMENT: u32 = 3;
/// Values of `Light::shadow` in the shaders.
pub(super) const SHADOW_NONE: u32 = 0;
pub(super) const SHADOW_MAP: u32 = 1;
pub(super) const SHADOW_CONE: u32 = 2;

/// The position and the distribution of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LightSource {
    /// Parallel light, such as the sun's.
    Directional {
        /// The direction in which the light travels; unit length.
        direction: Vec3,
        /// Irradiance on a surface that faces it, RGB.
        irradiance: Vec3,
        /// Half the angular diameter of the source, rad; for soft shadows. The sun: 0.00465.
        angular_radius_rad: f32,
    },
    /// Parallel light from a bright part of an environment map. The map still contains that part:
    /// mirrors reflect the map, not this light's highlight. [`crate::EnvironmentMap::lights`]
    /// creates such lights.
    Environment {
        /// The direction in which the light travels; unit length.
        direction: Vec3,
        /// Irradiance on a surface that faces it, RGB.
        irradiance: Vec3,
        /// Half the angular diameter of the source, rad.
        angular_radius_rad: f32,
    },
    /// Light in all directions.
    Point {
        /// Position, m.
        position: Vec3,
        /// Radiant intensity (flux per solid angle), RGB.
        intensity: Vec3,
        /// Radius of the source, m; for soft shadows, and the distance below which irradiance stops
        /// growing. 0: a point.
        radius_m: f32,
        /// Distance at which the light ends, m; `None`: never, as in nature.
        range_m: Option<f32>,
    },
    /// Light in a cone.
    Spot {
        /// Position, m.
        position: Vec3,
        /// The cone's axis: the direction in which the light travels; unit length.
        direction: Vec3,
        /// Radiant intensity inside the inner cone, RGB.
        intensity: Vec3,
        /// Half angle inside which the light has its full intensity, rad.
        inner_angle_rad: f32,
        /// Half angle outside which there is no light, rad; above the inner one, at most pi / 2.
        outer_angle_rad: f32,
        /// Radius of the source, m.
        radius_m: f32,
        /// Distance at which the light ends, m; `None`: never.
        range_m: Option<f32>,
    },
}

impl LightSource {
    /// The direction in which parallel light travels; `None` if the light comes from a position.
    pub fn parallel_direction(&self) -> Option<Vec3> {
        match *self {
            Self::Directional { direction, .. } | Self::Environment { direction, .. } => {
                Some(direction)
            }
            Self::Point { .. } | Self::Spot { .. } => None,
        }
    }

    /// The position; `None` if the light is parallel.
    pub fn position_mut(&mut self) -> Option<&mut Vec3> {
        match self {
            Self::Directional { .. } | Self::Environment { .. } => None,
            Self::Point { position, .. } | Self::Spot { position, .. } => Some(position),
        }
    }

    /// The position; `None` if the light is parallel.
    pub fn position(mut self) -> Option<Vec3> {
        self.position_mut().copied()
    }

    /// Distance at which the light ends, m; `None`: never.
    pub fn range_m(&self) -> Option<f32> {
        match *self {
            Self::Directional { .. } | Self::Environment { .. } => None,
            Self::Point { range_m, .. } | Self::Spot { range_m, .. } => range_m,
        }
    }

    /// Radius of the source, m; of parallel light half its angular diameter, rad.
    pub fn radius(&self) -> f32 {
        match *self {
            Self::Directional { angular_radius_rad: radius, .. }
            | Self::Environment { angular_radius_rad: radius, .. }
            | Self::Point { radius_m: radius, .. }
            | Self::Spot { radius_m: radius, .. } => radius,
        }
    }

    /// The irradiance of parallel light, the intensity of other light.
    pub fn strength_mut(&mut self) -> &mut Vec3 {
        match self {
            Self::Directional { irradiance: strength, .. }
            | Self::Environment { irradiance: strength, .. }
            | Self::Point { intensity: strength, .. }
            | Self::Spot { intensity: strength, .. } => strength,
        }
    }

    /// Layers of the shadow maps that the light needs.
    pub fn shadow_layers(&self) -> usize {
        if matches!(self, Self::Point { .. }) { 6 } else { 1 }
    }
}

/// The method for a light's shadows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Shadow {
    /// No shadows: the light passes through everything.
    None,
    /// Layers of the shadow maps: one, or six for a point light (+x, -x, +y, -y, +z, -z).
    Map {
        /// The light's first layer.
        first_layer: u32,
    },
    /// A cone through the voxels, as wide as the source: soft, at the resolution of the voxels,
    /// without a map.
    #[default]
    Cone,
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// The position and distribution.
    pub source: LightSource,
    /// The method for its shadows.
    pub shadow: Shadow,
}

/// One layer of the shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowLayer {
    /// Transform from the world to clip space, with reversed z (1 at the near plane).
    pub clip_from_world: Mat4,
    /// `true` if the projection is a perspective one (point and spot lights), `false` if it is
    /// parallel.
    pub is_perspective: bool,
    /// Edge of a texel: in metres per metre of distance for a perspective layer, in metres for a
    /// parallel one.
    pub texel_size: f32,
    /// `true` if the next layer belongs to the same parallel light, lies within this one and has
    /// smaller texels (cascaded shadow maps: Engel 2006). The last such layer around a point is
    /// sampled.
    pub has_finer: bool,
}

/// Depth maps of the lights: a `Depth32Float` array, all layers of one size, reversed z, cleared
/// to 0.
#[derive(Clone, Debug)]
pub struct ShadowMaps {
    /// A `D2Array` view of the depth texture.
    pub depth: TextureView,
    /// The projections of the layers.
    pub layers: Vec<ShadowLayer>,
}

/// `Light` of `lights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightRecord {
    pub(crate) position_in_world: [f32; 3],
    pub(crate) kind: u32,
    pub(crate) direction: [f32; 3],
    pub(crate) range_m: f32,
    pub(crate) intensity: [f32; 3],
    pub(crate) radius: f32,
    pub(crate) spot_scale: f32,
    pub(crate) spot_offset: f32,
    pub(crate) shadow: u32,
    pub(crate) shadow_layer: u32,
}

/// `LightGlobals` of `lights.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LightGlobals {
    pub(crate) environment: [f32; 3],
    pub(crate) light_count: u32,
    pub(crate) environment_turn: [f32; 2],
    pub(crate) mirror_alpha: f32,
    padding: u32,
}

/// `ShadowLayer` of `shadow_map.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ShadowLayerRecord {
    pub(crate) clip_from_world: Mat4,
    pub(crate) texel_size: f32,
    pub(crate) is_perspective: u32,
    pub(crate) has_finer: u32,
    pub(crate) padding: u32,
}

impl Light {
    /// Uploads lights in the shaders' format, an array of `Light` of `package::light::lights`, for
    /// a caller's own passes. Without lights the buffer contains a dark one, since bindings may not
    /// be empty.
    pub fn buffer(device: &wgpu::Device, lights: &[Self]) -> Buffer {
        let records: Vec<LightRecord> = lights.iter().map(|light| light.to_gpu()).collect();
        upload(device, "lights", &padded(&records))
    }

    fn to_gpu(self) -> LightRecord {
        let (shadow, shadow_layer) = match self.shadow {
            Shadow::None => (SHADOW_NONE, 0),
            Shadow::Map { first_layer } => (SHADOW_MAP, first_layer),
            Shadow::Cone => (SHADOW_CONE, 0),
        };
        let base = LightRecord { shadow, shadow_layer, ..LightRecord::zeroed() };
        match self.source {
            LightSource::Directional { direction, irradiance, angular_radius_rad } => LightRecord {
                kind: LIGHT_DIRECTIONAL,
                direction: direction.to_array(),
                intensity: irradiance.to_array(),
                radius: angular_radius_rad.tan(),
                ..base
            },
            LightSource::Environment { direction, irradiance, angular_radius_rad } => LightRecord {
                kind: LIGHT_ENVIRONMENT,
                direction: direction.to_array(),
                intensity: irradiance.to_array(),
                radius: angular_radius_rad.tan(),
                ..base
            },
            LightSource::Point { position, intensity, radius_m, range_m } => LightRecord {
                kind: LIGHT_POINT,
                position_in_world: position.to_array(),
                intensity: intensity.to_array(),
                radius: radius_m,
                range_m: range_m.unwrap_or(0.0),
                ..base
            },
            LightSource::Spot {
                position,
                direction,
                intensity,
                inner_angle_rad,
                outer_angle_rad,
                radius_m,
                range_m,
            } => {
                // KHR_lights_punctual, section "Inner and Outer Cone Angles".
                let spot_scale = 1.0 / (inner_angle_rad.cos() - outer_angle_rad.cos()).max(1e-3);
                LightRecord {
                    kind: LIGHT_SPOT,
                    position_in_world: position.to_array(),
                    direction: direction.to_array(),
                    intensity: intensity.to_array(),
                    radius: radius_m,
                    range_m: range_m.unwrap_or(0.0),
                    spot_scale,
                    spot_offset: -outer_angle_rad.cos() * spot_scale,
                    ..base
                }
            }
        }
    }
}

/// The records, or one zeroed record if there are none: WebGPU does not allow empty bindings.
fn padded<T: Pod>(records: &[T]) -> Vec<T> {
    if records.is_empty() { vec![T::zeroed()] } else { records.to_vec() }
}
