//! Lights and the environment: as the caller gives them, in radiometric (or photometric) units, and
//! on the GPU.
//!
//! The whole library uses one unit of radiance: if lights are in lux and candela, radiance is in
//! cd/m². The volumes hold half floats (6e-5 to 65504), so give very bright scenes in a larger
//! unit.

use std::sync::atomic::{AtomicU64, Ordering};

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, Vec3};

use crate::environment::{EnvironmentLight, EnvironmentMap};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, Texture, TextureView,
    uniform_buffer, upload,
};

/// Values of `Light::kind` in the shaders.
pub(crate) const LIGHT_DIRECTIONAL: u32 = 0;
pub(crate) const LIGHT_POINT: u32 = 1;
pub(crate) const LIGHT_SPOT: u32 = 2;
pub(crate) const LIGHT_ENVIRONMENT: u32 = 3;
/// Values of `Light::shadow` in the shaders.
pub(crate) const SHADOW_NONE: u32 = 0;
pub(crate) const SHADOW_MAP: u32 = 1;
pub(crate) const SHADOW_CONE: u32 = 2;

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
    /// Parallel light from a bright part of an environment map. The map shows that part: mirrors
    /// reflect the map, not this light's highlight. [`crate::EnvironmentMap::lights`] makes them.
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
        /// Radius of the source, m; for soft shadows, and the distance at which the light stops
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
    /// A cone through the voxels, as wide as the source: soft, as coarse as the voxels, and without
    /// a map.
    #[default]
    Cone,
}

/// A light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Light {
    /// Its position and distribution.
    pub source: LightSource,
    /// The method for its shadows.
    pub shadow: Shadow,
}

/// One layer of the shadow maps.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShadowLayer {
    /// From the world to clip space, with reversed z (1 at the near plane).
    pub clip_from_world: Mat4,
    /// Whether the projection is a perspective one (point and spot lights) or a parallel one.
    pub is_perspective: bool,
    /// Edge of a texel: in metres per metre of distance for a perspective layer, in metres for a parallel one.
    pub texel_size: f32,
}

/// Depth maps of the lights: a `Depth32Float` array, all layers of one size, reversed z, cleared to 0.
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
    pub(crate) padding: [u32; 2],
}

impl Light {
    /// Uploads lights in the shaders' form, `Light` of `package::light::lights` one after the
    /// other, for a caller's own passes. Without lights the buffer holds a dark one, since no
    /// binding may be empty.
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

/// The layout of group 2: lights, environment, shadow maps.
pub fn lights_layout(device: &Pipelines) -> wgpu::BindGroupLayout {
    LayoutBuilder::compute()
        .uniform()
        .storage()
        .storage()
        .depth_2d_array()
        .sampler_comparison()
        .texture_2d()
        .texture_2d()
        .sampler()
        .build(device, "lights")
}

/// Lights, environment and shadow maps bound for the shaders.
#[derive(Debug)]
pub struct Lights {
    /// The bind group, of the layout [`crate::Gi::lights_layout`].
    pub group: BindGroup,
    /// The number of lights.
    pub count: u32,
    /// A number that is unique to these resources: other bound resources have another.
    pub(crate) version: u64,
    /// Whether any light has shadows by cones.
    pub(crate) has_cone_shadows: bool,
    /// The lights with shadow maps.
    pub mapped: Vec<MappedLight>,
    /// Width and height of the maps, texels; zeros without any.
    pub map_size: [u32; 2],
}

/// A light with the layers of the shadow maps that are its own.
#[derive(Clone, Debug)]
pub struct MappedLight {
    /// Its index among the lights.
    pub index: u32,
    /// Its position and distribution.
    pub source: LightSource,
    /// Its first layer in the maps.
    pub first_layer: u32,
    /// Its layers.
    pub layers: Vec<ShadowLayer>,
}

impl Lights {
    /// Uploads lights. `environment` is the light from outside the grid; `white` replaces its map
    /// if it has none.
    ///
    /// A light whose shadow layer does not exist in `maps` gets its shadows by cones instead.
    pub(crate) fn new(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        lights: &[Light],
        environment: EnvironmentLight<'_>,
        white: &EnvironmentMap,
        maps: Option<&ShadowMaps>,
    ) -> Self {
        let layer_count = maps.map_or(0, |maps| maps.layers.len() as u32);
        let records: Vec<LightRecord> = lights
            .iter()
            .map(|light| {
                let needed = layers_of(&light.source) as u32;
                let shadow = match light.shadow {
                    Shadow::Map { first_layer } if first_layer + needed > layer_count => {
                        tracing::warn!(
                            "a light asks for shadow layers {first_layer} to {} of {layer_count}: it gets its shadows by cones",
                            first_layer + needed - 1
                        );
                        Shadow::Cone
                    }
                    shadow => shadow,
                };
                Light { shadow, ..*light }.to_gpu()
            })
            .collect();
        let mapped = maps.map(|maps| mapped(lights, &records, maps)).unwrap_or_default();
        let map_size = maps.map_or([0; 2], |maps| {
            let size = maps.depth.texture().size();
            [size.width, size.height]
        });
        let layers: Vec<ShadowLayerRecord> = maps
            .map(|maps| maps.layers.as_slice())
            .unwrap_or_default()
            .iter()
            .map(|layer| ShadowLayerRecord {
                clip_from_world: layer.clip_from_world,
                texel_size: layer.texel_size,
                is_perspective: u32::from(layer.is_perspective),
                padding: [0; 2],
            })
            .collect();
        let map = environment.map.unwrap_or(white);
        let globals = LightGlobals {
            environment: (environment.radiance * map.unit).to_array(),
            light_count: records.len() as u32,
            environment_turn: [environment.rotation_rad.cos(), environment.rotation_rad.sin()],
            mirror_alpha: mirror_alpha(&records),
            padding: 0,
        };
        let globals = uniform_buffer(device, "light globals", &globals);
        let lights = upload(device, "lights", &padded(&records));
        let layers = upload(device, "shadow layers", &padded(&layers));
        let no_map = maps.is_none().then(|| {
            let texture = Texture::new(
                device,
                &wgpu::TextureDescriptor {
                    label: Some("no shadow map"),
                    size: wgpu::Extent3d::default(),
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format: wgpu::TextureFormat::Depth32Float,
                    usage: wgpu::TextureUsages::TEXTURE_BINDING
                        | wgpu::TextureUsages::RENDER_ATTACHMENT,
                    view_formats: &[],
                },
            );
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(wgpu::TextureViewDimension::D2Array),
                ..Default::default()
            })
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("shadow comparison"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..Default::default()
        });
        let environment_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("environment"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let builder =
            BindGroupBuilder::new(layout).buffer(&globals).buffer(&lights).buffer(&layers);
        let builder = match (maps, &no_map) {
            (Some(maps), _) => builder.view(&maps.depth),
            (None, Some(view)) => builder.view(view),
            (None, None) => unreachable!("a fallback is made if there are no maps"),
        };
        let group = builder
            .sampler(&sampler)
            .view(&map.sharp)
            .view(&map.soft)
            .sampler(&environment_sampler)
            .build(device, "lights");
        Self {
            group,
            count: records.len() as u32,
            version: next_version(),
            has_cone_shadows: records.iter().any(|light| light.shadow == SHADOW_CONE),
            mapped,
            map_size,
        }
    }
}

/// A number that was not given out before.
fn next_version() -> u64 {
    static NEXT: AtomicU64 = AtomicU64::new(0);
    NEXT.fetch_add(1, Ordering::Relaxed)
}

/// The lights that have layers of the maps, which the records have checked.
fn mapped(lights: &[Light], records: &[LightRecord], maps: &ShadowMaps) -> Vec<MappedLight> {
    let with_records = lights.iter().zip(records).enumerate();
    with_records
        .filter(|(_, (_, record))| record.shadow == SHADOW_MAP)
        .map(|(index, (light, record))| {
            let layers = maps.layers.iter().skip(record.shadow_layer as usize);
            MappedLight {
                index: index as u32,
                source: light.source,
                first_layer: record.shadow_layer,
                layers: layers.take(layers_of(&light.source)).copied().collect(),
            }
        })
        .collect()
}

/// Layers of the shadow maps that a light needs.
fn layers_of(source: &LightSource) -> usize {
    if matches!(source, LightSource::Point { .. }) { 6 } else { 1 }
}

/// The alpha below which a lobe shows the shape of the widest light that belongs to the
/// environment: the normals of microfacets turn by half the angle of the reflection. 0 without such
/// lights.
fn mirror_alpha(records: &[LightRecord]) -> f32 {
    let parts = records.iter().filter(|light| light.kind == LIGHT_ENVIRONMENT);
    parts.map(|light| 0.5 * light.radius).fold(0.0, f32::max)
}

/// The records, or a single record of zeros if there are none: WebGPU has no empty bindings.
fn padded<T: Pod>(records: &[T]) -> Vec<T> {
    if records.is_empty() { vec![T::zeroed()] } else { records.to_vec() }
}
