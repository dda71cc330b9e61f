//! Lights bound for the shaders; updates need no rebinding.

use std::borrow::Cow;
use std::f32::consts::PI;

use bytemuck::Pod;
use half::f16;

use super::{
    LIGHT_ENVIRONMENT, Light, LightGlobals, LightRecord, LightSource, SHADOW_CONE, SHADOW_MAP,
    Shadow, ShadowLayer, ShadowLayerRecord, ShadowMaps, padded,
};
use crate::environment::{EnvironmentLight, EnvironmentMap};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, Texture, TextureView,
    uniform_buffer, upload,
};
use crate::mounted::{Mounted, Resource};
use crate::version;

/// The source of the shadows of lights with [`Shadow::Map`]. Converts from `None` and
/// `Some(&maps)`.
///
/// ```
/// # pollster::block_on(async {
/// # let (device, queue) = lumivox::gpu::open_device().await?;
/// # use glam::Vec3;
/// # use lumivox::hooks::Mounted;
/// # use lumivox::{Gi, GiConfig, Grid, Light, LightSource, Shadow, ShadowSource, wgpu};
/// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
/// // Shadows of an engine's own: whatever lies below a height is in the shade.
/// let module = "
///     import package::light::lights::Light;
///
///     @group(2) @binding(8) var<storage, read> height: f32;
///
///     fn shadow_map_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
///         return f32(position_in_world.y > height);
///     }";
/// let buffer = wgpu::BindingType::Buffer {
///     ty: wgpu::BufferBindingType::Storage { read_only: true },
///     has_dynamic_offset: false,
///     min_binding_size: None,
/// };
/// let shadow_maps = Some(Mounted::new(module, [buffer]));
/// let gi = Gi::new(&device, &queue, GiConfig { shadow_maps, ..GiConfig::new(grid) })?;
///
/// let source = LightSource::Directional {
///     direction: Vec3::NEG_Y,
///     irradiance: Vec3::ONE,
///     angular_radius_rad: 0.0,
/// };
/// let sun = Light { source, shadow: Shadow::Map { first_layer: 0 } };
/// let height = lumivox::gpu::upload(&device, "height", &[0.5_f32]);
/// let own = [(*height).clone().into()];
/// let lights = gi.bind_lights(&[sun], Vec3::ZERO, ShadowSource::Own(&own));
/// assert_eq!(lights.count, 1);
/// # Ok::<(), lumivox::GiError>(())
/// # }).unwrap();
/// ```
#[derive(Clone, Copy, Debug)]
pub enum ShadowSource<'a> {
    /// There are no shadow maps.
    None,
    /// Maps in Lumivox's own layout.
    Maps(&'a ShadowMaps),
    /// The resources of the caller's own module ([`crate::GiConfig::shadow_maps`]), in the order of
    /// its bindings.
    Own(&'a [Resource]),
}

impl<'a> From<Option<&'a ShadowMaps>> for ShadowSource<'a> {
    fn from(maps: Option<&'a ShadowMaps>) -> Self {
        maps.map_or(Self::None, Self::Maps)
    }
}

/// The bindings of shadow maps in Lumivox's own layout.
const MAP_BINDINGS: u32 = 3;

/// The layout of group 2: lights, shadow maps in Lumivox's layout, environment, and then the
/// bindings of the caller's own module of shadow maps.
pub fn lights_layout(device: &Pipelines, own: Option<&Mounted>) -> wgpu::BindGroupLayout {
    let lights = LayoutBuilder::compute().uniform().storage();
    let maps = match own {
        Some(_) => lights.skip(MAP_BINDINGS),
        None => lights.storage().depth_2d_array().sampler_comparison(),
    };
    let environment = maps.texture_2d().texture_2d().sampler();
    let bindings = own.map(|own| own.bindings.as_slice()).unwrap_or_default();
    let layout = bindings.iter().fold(environment, |layout, ty| layout.binding(*ty));
    layout.build(device, "lights")
}

/// Lights, environment and shadow maps bound for the shaders.
#[derive(Debug)]
pub struct Lights {
    /// The bind group, of the layout [`crate::Gi::lights_layout`]. [`Self::update`] may replace it.
    pub group: BindGroup,
    /// Number of lights.
    pub count: u32,
    /// A number that is unique to these lights and changes whenever they do.
    pub(crate) version: u64,
    /// `true` if any light has cone shadows, or may have them where a caller's own maps do not
    /// reach.
    #[doc(hidden)]
    pub has_cone_shadows: bool,
    /// The lights that have shadow maps.
    pub mapped: Vec<MappedLight>,
    /// Width and height of the maps, texels; zero without any.
    pub map_size: [u32; 2],
    /// The contents of the next three buffers.
    known: Records,
    globals: Buffer,
    records: Buffer,
    layers: Buffer,
    textures: Textures,
    stand_ins: StandIns,
    device: wgpu::Device,
    layout: wgpu::BindGroupLayout,
}

/// A light and its layers of the shadow maps.
#[derive(Clone, Debug)]
pub struct MappedLight {
    /// The light's index.
    pub index: u32,
    /// The light's position and distribution.
    pub source: LightSource,
    /// The light's first layer among all of the maps.
    pub first_layer: u32,
    /// The light's layers: the six faces of a point light; otherwise one layer, and the finer ones
    /// within it.
    pub layers: Vec<ShadowLayer>,
}

/// The bound textures.
#[derive(Clone, Debug, PartialEq)]
struct Textures {
    shadows: ShadowTextures,
    sharp: TextureView,
    soft: TextureView,
}

#[derive(Clone, Debug, PartialEq)]
enum ShadowTextures {
    Maps(TextureView),
    Own(Vec<Resource>),
}

/// Fallbacks for missing textures, and the samplers.
#[derive(Debug)]
struct StandIns {
    no_map: TextureView,
    white: [TextureView; 2],
    white_unit: f32,
    shadow_sampler: wgpu::Sampler,
    environment_sampler: wgpu::Sampler,
}

/// Lights in the shaders' format.
#[derive(Debug)]
struct Records {
    globals: LightGlobals,
    lights: Vec<LightRecord>,
    layers: Vec<ShadowLayerRecord>,
}

impl Lights {
    /// Uploads lights. `environment` is what lies outside the grid; `white` is the fallback for its
    /// map.
    ///
    /// A light whose shadow layer does not exist in the maps gets cone shadows instead.
    pub(crate) fn new(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        lights: &[Light],
        environment: EnvironmentLight<'_>,
        white: &EnvironmentMap,
        shadows: ShadowSource<'_>,
    ) -> Self {
        let lights = &*with_suns(lights, environment);
        let stand_ins = StandIns::new(device, white);
        let records = Records::new(lights, environment, stand_ins.white_unit, shadows);
        let textures = stand_ins.textures(environment, shadows);
        let globals = uniform_buffer(device, "light globals", &records.globals);
        let light_buffer = upload(device, "lights", &padded(&records.lights));
        let layers = upload(device, "shadow layers", &padded(&records.layers));
        let group =
            bind((device, layout), [&globals, &light_buffer, &layers], &textures, &stand_ins);
        let mut bound = Self {
            group,
            count: 0,
            version: 0,
            has_cone_shadows: false,
            mapped: Vec::new(),
            map_size: [0; 2],
            known: records,
            globals,
            records: light_buffer,
            layers,
            textures,
            stand_ins,
            device: device.clone(),
            layout: layout.clone(),
        };
        bound.describe(lights, shadows);
        bound
    }

    /// Replaces lights, environment and shadow layers from the next submission on. Light in the
    /// voxels does not change before the next [`crate::Gi::light`].
    ///
    /// The parameters are those of [`crate::Gi::bind_lights`]; does nothing if they have not
    /// changed. Buffers and the bind group are kept, unless there are more lights or layers than
    /// ever before, or other textures.
    pub fn update<'a>(
        &mut self,
        queue: &wgpu::Queue,
        lights: &[Light],
        environment: impl Into<EnvironmentLight<'a>>,
        shadows: impl Into<ShadowSource<'a>>,
    ) {
        let (environment, shadows) = (environment.into(), shadows.into());
        let lights = &*with_suns(lights, environment);
        let records = Records::new(lights, environment, self.stand_ins.white_unit, shadows);
        let textures = self.stand_ins.textures(environment, shadows);
        if textures == self.textures && records.are_same(&self.known) {
            return;
        }
        queue.write_buffer(&self.globals, 0, bytemuck::bytes_of(&records.globals));
        let device = self.device.clone();
        let has_grown = [
            write_or_grow((&device, queue), &mut self.records, "lights", &records.lights),
            write_or_grow((&device, queue), &mut self.layers, "shadow layers", &records.layers),
        ];
        if has_grown.contains(&true) || textures != self.textures {
            self.textures = textures;
            self.group = bind(
                (&device, &self.layout),
                [&self.globals, &self.records, &self.layers],
                &self.textures,
                &self.stand_ins,
            );
        }
        self.known = records;
        self.describe(lights, shadows);
    }

    /// Lights the voxels again. Call it when the contents of bound resources have changed, such as
    /// the caller's shadow maps or an [`EnvironmentCube`](crate::EnvironmentCube).
    pub fn invalidate(&mut self) {
        self.version = version::next();
    }

    /// Updates the fields that describe the lights on the CPU.
    fn describe(&mut self, lights: &[Light], shadows: ShadowSource<'_>) {
        let records = &self.known;
        self.count = records.globals.light_count;
        self.version = version::next();
        let has_own_maps = matches!(shadows, ShadowSource::Own(_));
        self.has_cone_shadows = records
            .lights
            .iter()
            .any(|light| light.shadow == SHADOW_CONE || has_own_maps && light.shadow == SHADOW_MAP);
        (self.mapped, self.map_size) = match shadows {
            ShadowSource::Maps(maps) => {
                let size = maps.depth.texture().size();
                (mapped(lights, &records.lights, maps), [size.width, size.height])
            }
            ShadowSource::None | ShadowSource::Own(_) => (Vec::new(), [0; 2]),
        };
    }
}

/// The lights; unless some of them are from the environment's map, the map's brightest parts
/// follow, with cone shadows.
fn with_suns<'a>(lights: &'a [Light], environment: EnvironmentLight<'_>) -> Cow<'a, [Light]> {
    let is_sun = |light: &Light| matches!(light.source, LightSource::Environment { .. });
    let Some(map) = environment.map.filter(|_| !lights.iter().any(is_sun)) else {
        return Cow::Borrowed(lights);
    };
    let suns = map.lights(environment.radiance, environment.rotation_rad);
    lights.iter().copied().chain(suns).collect()
}

/// Writes records into a buffer. If they do not fit, creates a larger one and returns `true`.
fn write_or_grow<T: Pod>(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    buffer: &mut Buffer,
    label: &str,
    records: &[T],
) -> bool {
    let bytes: &[u8] = bytemuck::cast_slice(records);
    if bytes.len() as u64 <= buffer.size() {
        queue.write_buffer(buffer, 0, bytes);
        return false;
    }
    let mut roomy = records.to_vec();
    roomy.resize(records.len().next_power_of_two(), T::zeroed());
    *buffer = upload(device, label, &roomy);
    true
}

fn bind(
    (device, layout): (&wgpu::Device, &wgpu::BindGroupLayout),
    [globals, lights, layers]: [&Buffer; 3],
    textures: &Textures,
    stand_ins: &StandIns,
) -> BindGroup {
    let group = BindGroupBuilder::new(layout).buffer(globals).buffer(lights);
    let (group, own) = match &textures.shadows {
        ShadowTextures::Maps(view) => {
            (group.buffer(layers).view(view).sampler(&stand_ins.shadow_sampler), [].as_slice())
        }
        ShadowTextures::Own(own) => (group.skip(MAP_BINDINGS), own.as_slice()),
    };
    let group =
        group.view(&textures.sharp).view(&textures.soft).sampler(&stand_ins.environment_sampler);
    own.iter()
        .fold(group, |group, resource| group.resource(resource.binding()))
        .build(device, "lights")
}

impl StandIns {
    fn new(device: &wgpu::Device, white: &EnvironmentMap) -> Self {
        let no_map = Texture::new(
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
        )
        .create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let shadow_sampler = device.create_sampler(&wgpu::SamplerDescriptor {
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
        let white_views = [white.sharp.clone(), white.soft.clone()];
        Self {
            no_map,
            white: white_views,
            white_unit: white.unit,
            shadow_sampler,
            environment_sampler,
        }
    }

    fn textures(&self, environment: EnvironmentLight<'_>, shadows: ShadowSource<'_>) -> Textures {
        let [sharp, soft] = &self.white;
        let (sharp, soft) = environment.map.map_or((sharp, soft), |map| (&map.sharp, &map.soft));
        let shadows = match shadows {
            ShadowSource::None => ShadowTextures::Maps(self.no_map.clone()),
            ShadowSource::Maps(maps) => ShadowTextures::Maps(maps.depth.clone()),
            ShadowSource::Own(own) => ShadowTextures::Own(own.to_vec()),
        };
        Textures { shadows, sharp: sharp.clone(), soft: soft.clone() }
    }
}

impl Records {
    /// `true` if both have the same bits.
    fn are_same(&self, other: &Self) -> bool {
        fn bits<T: Pod>(records: &[T]) -> &[u32] {
            bytemuck::cast_slice(records)
        }
        bytemuck::bytes_of(&self.globals) == bytemuck::bytes_of(&other.globals)
            && bits(&self.lights) == bits(&other.lights)
            && bits(&self.layers) == bits(&other.layers)
    }

    fn new(
        lights: &[Light],
        environment: EnvironmentLight<'_>,
        white_unit: f32,
        shadows: ShadowSource<'_>,
    ) -> Self {
        let layers = match shadows {
            ShadowSource::Maps(maps) => maps.layers.as_slice(),
            ShadowSource::None | ShadowSource::Own(_) => &[],
        };
        // The number of layers of the caller's own module is unknown.
        let layer_count =
            if matches!(shadows, ShadowSource::Own(_)) { u32::MAX } else { layers.len() as u32 };
        let lights: Vec<LightRecord> =
            lights.iter().map(|light| with_layers(light, layer_count).to_gpu()).collect();
        let unit = environment.map.map_or(white_unit, |map| map.unit);
        let globals = LightGlobals {
            environment: (environment.radiance * unit).to_array(),
            light_count: lights.len() as u32,
            environment_turn: [environment.rotation_rad.cos(), environment.rotation_rad.sin()],
            mirror_alpha: mirror_alpha(&lights),
            padding: 0,
        };
        let record = |layer: &ShadowLayer, has_finer| ShadowLayerRecord {
            clip_from_world: layer.clip_from_world,
            texel_size: layer.texel_size,
            is_perspective: u32::from(layer.is_perspective),
            has_finer: u32::from(has_finer),
            padding: 0,
        };
        let finer = layers.iter().skip(1).map(|finer| !finer.is_perspective).chain([false]);
        let layers =
            layers.iter().zip(finer).map(|(l, is_finer)| record(l, l.has_finer && is_finer));
        Self { globals, lights, layers: layers.collect() }
    }
}

/// The light; with cone shadows instead if its shadow layers do not exist.
fn with_layers(light: &Light, layer_count: u32) -> Light {
    let needed = light.source.shadow_layers() as u32;
    let shadow = match light.shadow {
        Shadow::Map { first_layer } if first_layer.saturating_add(needed) > layer_count => {
            tracing::warn!(
                "a light asks for shadow layers {first_layer} to {} of {layer_count}: it gets its shadows by cones",
                first_layer.saturating_add(needed - 1)
            );
            Shadow::Cone
        }
        shadow => shadow,
    };
    Light { shadow, ..*light }
}

/// The lights with shadow maps. Their layers were checked when the records were created.
fn mapped(lights: &[Light], records: &[LightRecord], maps: &ShadowMaps) -> Vec<MappedLight> {
    let with_records = lights.iter().zip(records).enumerate();
    with_records
        .filter(|(_, (_, record))| record.shadow == SHADOW_MAP)
        .map(|(index, (light, record))| {
            let layers = &maps.layers[record.shadow_layer as usize..];
            let finer = layers.iter().take_while(|layer| layer.has_finer).count();
            let count = (light.source.shadow_layers() + finer).min(layers.len());
            MappedLight {
                index: index as u32,
                source: light.source,
                first_layer: record.shadow_layer,
                layers: layers[..count].to_vec(),
            }
        })
        .collect()
}

/// The alpha below which a lobe shows the shape of the widest environment light: the microfacets'
/// normals turn by half the angle of the reflection. 0 without such lights. Peaks whose radiance
/// exceeds a half float are ignored: the map and the reflections would clamp it.
fn mirror_alpha(records: &[LightRecord]) -> f32 {
    let fits = |light: &&LightRecord| {
        let brightest = light.intensity.into_iter().fold(0.0, f32::max);
        brightest <= f16::MAX.to_f32() * PI * light.radius * light.radius
    };
    let parts = records.iter().filter(|light| light.kind == LIGHT_ENVIRONMENT).filter(fits);
    parts.map(|light| 0.5 * light.radius).fold(0.0, f32::max)
}
