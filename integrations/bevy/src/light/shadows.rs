//! Bevy's shadow maps, for the light in voxels.
//!
//! A sun's cascades cover only boxes around what a camera sees. Voxels outside these boxes get
//! shadows from cones. So do lights that have no map in a frame, because no camera sees what they
//! light.

use bevy::ecs::system::SystemParam;
use bevy::pbr::{
    ExtractedPointLight, GlobalClusterableObjectMeta, LightEntity, PointAndSpotLightViewEntities,
    ViewLightEntities, ViewShadowBindings,
};
use bevy::prelude::*;
use bevy::render::render_resource::TextureId;
use bevy::render::view::ExtractedView;
use lumivox::gpu::{Buffer, upload};
use lumivox::hooks::{Mounted, Resource as Bound};
use lumivox::{LightSource, Shadow, wgpu};

use crate::light::lights::SceneLight;

/// `ShadowLayer` of `shadow_maps.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
struct ShadowLayer {
    clip_from_world: Mat4,
    layer: u32,
    texel_size: f32,
    cascades: u32,
    padding: u32,
}

impl ShadowLayer {
    /// The layer of a depth texture that a light's view draws into; `width` is the texture's, in
    /// texels.
    fn of(view: &ExtractedView, layer: u32, width: u32) -> Self {
        Self {
            clip_from_world: view.clip_from_view * view.world_from_view.to_matrix().inverse(),
            layer,
            // This element scales half the visible width to 1. The width is in metres, or in metres
            // per metre of distance.
            texel_size: 2.0 / (view.clip_from_view.x_axis.x * width as f32),
            cascades: 0,
            padding: 0,
        }
    }
}

/// The module that reads them (`shadow_maps.wgsl`), with its bindings.
pub(crate) fn module() -> Mounted {
    let maps = wgpu::BindingType::Texture {
        sample_type: wgpu::TextureSampleType::Depth,
        view_dimension: wgpu::TextureViewDimension::D2Array,
        multisampled: false,
    };
    let layers = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let sampler = wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison);
    Mounted::new(include_str!("shadow_maps.wgsl"), [layers, maps, maps, sampler])
}

/// Bevy's data about its shadow maps in a frame.
#[derive(SystemParam)]
pub(crate) struct BevyShadows<'w, 's> {
    order: Option<Res<'w, GlobalClusterableObjectMeta>>,
    lights: Query<'w, 's, (&'static ExtractedPointLight, &'static PointAndSpotLightViewEntities)>,
    views: Query<'w, 's, &'static ExtractedView>,
    cascades: Query<'w, 's, (&'static LightEntity, &'static ExtractedView)>,
}

/// The shadow maps and their bindings.
pub(crate) struct ShadowMaps {
    textures: Option<[TextureId; 2]>,
    layers: Vec<ShadowLayer>,
    buffer: Buffer,
    pub(crate) bound: [Bound; 4],
}

impl ShadowMaps {
    /// Bindings without shadow maps.
    pub(crate) fn none(device: &wgpu::Device) -> Self {
        let nothing = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("no shadow maps"),
            size: wgpu::Extent3d::default(),
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Depth32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::RENDER_ATTACHMENT,
            view_formats: &[],
        });
        let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("Bevy's shadow maps"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            compare: Some(wgpu::CompareFunction::GreaterEqual),
            ..wgpu::SamplerDescriptor::default()
        });
        let buffer = upload(
            device,
            "Bevy's shadow layers",
            &[<ShadowLayer as bytemuck::Zeroable>::zeroed()],
        );
        let nothing = array_view(&nothing);
        let bound =
            [(*buffer).clone().into(), nothing.clone().into(), nothing.into(), sampler.into()];
        Self { textures: None, layers: Vec::new(), buffer, bound }
    }

    /// Binds Bevy's maps for a camera, and sets each light's kind of shadow.
    pub(crate) fn follow(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        (maps, cascades): (&ViewShadowBindings, &ViewLightEntities),
        known: &BevyShadows<'_, '_>,
        lights: &mut [SceneLight],
    ) {
        let textures = [&maps.point_light_depth_texture, &maps.directional_light_depth_texture];
        let ids = textures.map(|texture| texture.id());
        if self.textures != Some(ids) {
            let [cubes, flat] = textures.map(|texture| array_view(texture));
            (self.bound[1], self.bound[2]) = (cubes.into(), flat.into());
            self.textures = Some(ids);
        }
        let before = std::mem::take(&mut self.layers);
        let first_spot = FirstSpot::find(known, textures[1].depth_or_array_layers());
        for light in lights {
            if light.light.shadow == Shadow::None {
                continue;
            }
            light.light.shadow = Shadow::Cone;
            let first_layer = self.layers.len();
            let sizes = textures.map(|texture| texture.size());
            let layers = match light.light.source {
                LightSource::Directional { .. } => known.sun(light.entity, sizes[1], cascades),
                _ => known.lamp(light.entity, sizes, &first_spot),
            };
            self.layers.extend(layers.into_iter().flatten());
            if self.layers.len() > first_layer {
                light.light.shadow = Shadow::Map { first_layer: first_layer as u32 };
            }
        }
        if self.layers == before || self.layers.is_empty() {
            return;
        }
        let bytes: &[u8] = bytemuck::cast_slice(&self.layers);
        if self.buffer.size() >= bytes.len() as u64 {
            queue.write_buffer(&self.buffer, 0, bytes);
        } else {
            let mut room = self.layers.clone();
            room.resize(room.len().next_power_of_two(), bytemuck::Zeroable::zeroed());
            self.buffer = upload(device, "Bevy's shadow layers", &room);
            self.bound[0] = (*self.buffer).clone().into();
        }
    }
}

impl BevyShadows<'_, '_> {
    /// The layers of a sun's cascades for a camera; `None` if Bevy has not drawn them.
    fn sun(
        &self,
        sun: Entity,
        flat: wgpu::Extent3d,
        cascades: &ViewLightEntities,
    ) -> Option<Vec<ShadowLayer>> {
        // In layer order: sun by sun, and the cascade nearest to the camera first.
        let drawn = (0..flat.depth_or_array_layers).zip(&cascades.lights);
        let mut layers: Vec<ShadowLayer> = drawn
            .filter_map(|(layer, view)| match self.cascades.get(*view) {
                Ok((LightEntity::Directional { light_entity, .. }, view))
                    if *light_entity == sun =>
                {
                    Some(ShadowLayer::of(view, layer, flat.width))
                }
                _ => None,
            })
            .collect();
        layers.first_mut()?.cascades = layers.len() as u32;
        Some(layers)
    }

    /// The layers of a point or spot light; `None` if Bevy has not drawn them.
    fn lamp(
        &self,
        lamp: Entity,
        [cubes, flat]: [wgpu::Extent3d; 2],
        first_spot: &FirstSpot,
    ) -> Option<Vec<ShadowLayer>> {
        let (extracted, views) = self.lights.get(lamp).ok()?;
        let index = *self.order.as_ref()?.entity_to_index.get(&lamp)?;
        let is_spot = extracted.spot_light_angles.is_some();
        let first = if is_spot { first_spot.layer_of(index)? } else { 6 * index as u32 };
        let (size, faces) = if is_spot { (flat, 1) } else { (cubes, 6) };
        let is_drawn = extracted.shadow_maps_enabled
            && first + faces <= size.depth_or_array_layers
            && views.len() == faces as usize;
        if !is_drawn {
            return None;
        }
        let layer = |(layer, view): (u32, &Entity)| {
            Some(ShadowLayer::of(self.views.get(*view).ok()?, layer, size.width))
        };
        (first..).zip(views.iter()).map(layer).collect()
    }
}

/// Index of the first spot light among lights, and among layers.
struct FirstSpot {
    light: usize,
    layer: usize,
}

impl FirstSpot {
    fn find(known: &BevyShadows<'_, '_>, layers: u32) -> Self {
        let is_spot = |light: &ExtractedPointLight| light.spot_light_angles.is_some();
        let (mut points, mut mapped_spots) = (0, 0);
        for (light, _) in &known.lights {
            points += usize::from(!is_spot(light));
            mapped_spots += usize::from(is_spot(light) && light.shadow_maps_enabled);
        }
        // The suns' cascades come before them.
        Self { light: points, layer: (layers as usize).saturating_sub(mapped_spots) }
    }

    fn layer_of(&self, index: usize) -> Option<u32> {
        Some((index.checked_sub(self.light)? + self.layer) as u32)
    }
}

fn array_view(texture: &wgpu::Texture) -> wgpu::TextureView {
    texture.create_view(&wgpu::TextureViewDescriptor {
        label: Some("Bevy's shadow maps"),
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        aspect: wgpu::TextureAspect::DepthOnly,
        ..wgpu::TextureViewDescriptor::default()
    })
}
