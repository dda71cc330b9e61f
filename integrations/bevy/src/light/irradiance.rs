//! Passes the light of the probes to Bevy as irradiance volumes, for everything that is drawn
//! forward: transparent objects, forward materials, and all of an app in forward mode.
//!
//! Bevy's forward shaders support irradiance volumes (ambient cubes; Mitchell 2006, "Shading in
//! Valve's Source Engine"), so the light of the probes (`probes.rs`) is written into the texture of
//! such a volume. Deferred surfaces have their own cones, but Bevy's deferred lighting pass reads
//! the same texture. So the texture holds the light only from the end of that pass to the end of
//! the transparent pass, and is black otherwise.

use std::any::TypeId;
use std::sync::{Arc, Mutex, PoisonError};

use bevy::asset::RenderAssetUsages;
use bevy::camera::visibility::{NoFrustumCulling, RenderLayers, VisibleEntities};
use bevy::core_pipeline::core_3d::{AlphaMask3d, Opaque3d, Transparent3d};
use bevy::ecs::system::SystemParam;
use bevy::light::cluster::ClusterVisibilityClass;
use bevy::light::{IrradianceVolume, LightProbe};
use bevy::pbr::Transmissive3d;
use bevy::prelude::*;
use bevy::render::Extract;
use bevy::render::render_asset::RenderAssets;
use bevy::render::render_phase::{ViewBinnedRenderPhases, ViewSortedRenderPhases};
use bevy::render::render_resource::{Extent3d, TextureDimension, TextureFormat, TextureUsages};
use bevy::render::renderer::{RenderContext, RenderQueue, ViewQuery};
use bevy::render::texture::GpuImage;
use bevy::render::view::ExtractedView;
use lumivox::Gi;
use lumivox::gpu::Recorder;

use crate::light::probes::{ProbeGrid, Probes};
use crate::screen::views::GiViews;
use crate::settings::LumivoxGi;
use crate::volumes::{VolumeKey, Volumes};

/// Bevy binds no irradiance volumes in browsers (`IRRADIANCE_VOLUMES_ARE_USABLE`).
pub(crate) const ARE_USABLE: bool = cfg!(not(target_arch = "wasm32"));
/// Frames after which a new texture is on the GPU.
const FRAMES_TO_UPLOAD: u32 = 3;

/// An irradiance volume that the render world requests from the main world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Offer {
    key: VolumeKey,
    grid: ProbeGrid,
    /// The texture's unit of radiance, cd/m².
    unit: f32,
}

impl Offer {
    /// Requests a volume for shown voxels. Without lit probes it is a single dark cell, so that
    /// Bevy's pipelines, which depend on whether there is an irradiance volume, stay the same.
    pub(crate) fn new(key: VolumeKey, gi: &Gi, probes: Option<&Probes>, unit: f32) -> Self {
        let whole = ProbeGrid { low: gi.grid().min_in_world(), edge: 1.0, cells: UVec3::ONE };
        let grid = probes.filter(|probes| probes.are_lit()).map_or(whole, |probes| probes.grid);
        Self { key, grid, unit }
    }
}

/// Requested volumes, shared by both worlds.
#[derive(Resource, Clone, Default)]
pub(crate) struct Offers(Arc<Mutex<Vec<Offer>>>);

impl Offers {
    pub(crate) fn set(&self, offers: impl Iterator<Item = Offer>) {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.clear();
        held.extend(offers);
    }
}

/// Marks an irradiance volume that Lumivox made.
#[derive(Component, Debug)]
pub(crate) struct OwnVolume {
    offer: Offer,
    /// The next texture, with its offer and its age in frames. It replaces the shown one once it is
    /// on the GPU.
    coming: Option<(Offer, Handle<Image>, u32)>,
    frames: u32,
}

/// Creates, updates and removes Bevy's irradiance volumes to match the offers.
pub(crate) fn follow_offers(
    offers: Res<Offers>,
    mut commands: Commands,
    mut images: ResMut<Assets<Image>>,
    mut volumes: Query<(Entity, &mut OwnVolume, &mut IrradianceVolume, &mut Transform)>,
) {
    let offers = offers.0.lock().unwrap_or_else(PoisonError::into_inner).clone();
    let mut known = Vec::new();
    for (entity, mut own, mut volume, mut transform) in &mut volumes {
        let Some(offer) = offers.iter().find(|offer| offer.key == own.offer.key) else {
            commands.entity(entity).despawn();
            continue;
        };
        known.push(offer.key);
        own.frames = own.frames.saturating_add(1);
        if let Some((coming, image, frames)) = &mut own.coming {
            *frames += 1;
            if *frames >= FRAMES_TO_UPLOAD {
                let (coming, image) = (*coming, image.clone());
                volume.voxels = image;
                own.offer = coming;
                own.coming = None;
                *transform = place(&coming);
                volume.intensity = coming.unit;
            }
        } else if offer.grid.cells != own.offer.grid.cells {
            own.coming = Some((*offer, images.add(texture(&offer.grid)), 0));
        } else if *offer != own.offer {
            own.offer = *offer;
            *transform = place(offer);
            volume.intensity = offer.unit;
        }
    }
    for offer in offers.iter().filter(|offer| ARE_USABLE && !known.contains(&offer.key)) {
        let voxels = images.add(texture(&offer.grid));
        let volume = IrradianceVolume { voxels, intensity: offer.unit, ..default() };
        let own = OwnVolume { offer: *offer, coming: None, frames: 0 };
        let everywhere = RenderLayers::from_layers(&std::array::from_fn::<usize, 64, _>(|n| n));
        commands.spawn((
            (own, volume, LightProbe::new(), place(offer)),
            (NoFrustumCulling, everywhere, Name::new("Lumivox")),
        ));
    }
}

/// On a camera in the main world: the volume that lights it. If the camera asks for another volume,
/// the old one stays until the new one is ready.
#[derive(Component, Clone, Copy, Debug, PartialEq)]
pub(crate) struct LitFrom(VolumeKey);

impl LitFrom {
    /// The volume that lights a camera. A new camera has no `LitFrom` yet, and gets its own volume.
    pub(crate) fn key(lit_from: Option<&Self>, gi: &LumivoxGi, camera: Entity) -> VolumeKey {
        lit_from.map_or_else(|| VolumeKey::new(&gi.volume, camera), |lit_from| lit_from.0)
    }
}

/// Chooses the volume that lights each camera. Runs after [`follow_offers`].
pub(crate) fn choose_keys(
    offers: Res<Offers>,
    mut commands: Commands,
    own: Query<&OwnVolume>,
    cameras: Query<(Entity, &LumivoxGi, Option<&LitFrom>)>,
    gone: Query<Entity, (With<LitFrom>, Without<LumivoxGi>)>,
) {
    let offers = offers.0.lock().unwrap_or_else(PoisonError::into_inner);
    let is_shown = |key: &VolumeKey| offers.iter().any(|offer| offer.key == *key);
    let is_uploaded = |key: &VolumeKey| {
        !ARE_USABLE || own.iter().any(|own| own.offer.key == *key && own.frames >= FRAMES_TO_UPLOAD)
    };
    for (camera, gi, lit_from) in &cameras {
        let wanted = VolumeKey::new(&gi.volume, camera);
        let is_ready = is_shown(&wanted) && is_uploaded(&wanted);
        let key = match lit_from {
            Some(LitFrom(former)) if !is_ready && is_shown(former) => *former,
            _ => wanted,
        };
        if lit_from != Some(&LitFrom(key)) {
            commands.entity(camera).try_insert(LitFrom(key));
        }
    }
    for camera in &gone {
        commands.entity(camera).try_remove::<LitFrom>();
    }
}

fn place(offer: &Offer) -> Transform {
    let size = offer.grid.size();
    Transform::from_translation(offer.grid.low + 0.5 * size).with_scale(size)
}

fn texture(grid: &ProbeGrid) -> Image {
    let UVec3 { x, y, z } = grid.cells * UVec3::new(1, 2, 3);
    let size = Extent3d { width: x, height: y, depth_or_array_layers: z };
    let mut image = Image::new_uninit(
        size,
        TextureDimension::D3,
        TextureFormat::Rgba16Float,
        RenderAssetUsages::RENDER_WORLD,
    );
    image.texture_descriptor.usage =
        TextureUsages::TEXTURE_BINDING | TextureUsages::STORAGE_BINDING;
    image
}

/// Shows each camera only the irradiance volume of its own voxels, and other cameras none of
/// Lumivox's. Runs after Bevy's visibility check.
pub(crate) fn choose_volumes(
    mut cameras: Query<
        (Entity, &mut VisibleEntities, Option<&LumivoxGi>, Option<&LitFrom>),
        With<Camera3d>,
    >,
    own: Query<&OwnVolume>,
    all: Query<(), With<IrradianceVolume>>,
) {
    let class = TypeId::of::<ClusterVisibilityClass>();
    for (camera, mut visible, gi, lit_from) in &mut cameras {
        if !visible.entities.contains_key(&class) {
            continue;
        }
        let key = gi.map(|gi| LitFrom::key(lit_from, gi, camera));
        let is_there = key.is_some_and(|key| own.iter().any(|own| own.offer.key == key));
        visible.get_mut(class).retain(|entity| match own.get(*entity) {
            Ok(own) => Some(own.offer.key) == key,
            // Hide the app's own volumes: walls do not block their light.
            Err(_) => !(is_there && all.contains(*entity)),
        });
    }
}

/// Lumivox's irradiance volumes, extracted from the main world.
#[derive(Resource, Default)]
pub(crate) struct ShownVolumes(Vec<(Offer, AssetId<Image>)>);

impl ShownVolumes {
    pub(crate) fn has(&self, key: &VolumeKey) -> bool {
        self.0.iter().any(|(offer, _)| offer.key == *key)
    }
}

pub(crate) fn extract_volumes(
    mut shown: ResMut<ShownVolumes>,
    volumes: Extract<Query<(&OwnVolume, &IrradianceVolume)>>,
) {
    shown.0.clear();
    shown.0.extend(volumes.iter().map(|(own, volume)| (own.offer, volume.voxels.id())));
}

/// The phases of Bevy's forward passes, to see which views draw anything in them.
#[derive(SystemParam)]
pub(crate) struct Forward<'w> {
    opaque: Res<'w, ViewBinnedRenderPhases<Opaque3d>>,
    masked: Res<'w, ViewBinnedRenderPhases<AlphaMask3d>>,
    transmissive: Res<'w, ViewSortedRenderPhases<Transmissive3d>>,
    transparent: Res<'w, ViewSortedRenderPhases<Transparent3d>>,
}

impl Forward<'_> {
    /// Whether the view draws anything forward.
    pub(crate) fn is_in(&self, view: &ExtractedView) -> bool {
        let key = &view.retained_view_entity;
        self.opaque.get(key).is_some_and(|phase| !phase.is_empty())
            || self.masked.get(key).is_some_and(|phase| !phase.is_empty())
            || self.transmissive.get(key).is_some_and(|phase| !phase.items.is_empty())
            || self.transparent.get(key).is_some_and(|phase| !phase.items.is_empty())
    }
}

/// Writes the light into the texture, for the forward passes that follow.
pub(crate) fn fill_volume(
    view: ViewQuery<Entity>,
    mut context: RenderContext,
    (volumes, shown): (ResMut<Volumes>, Res<ShownVolumes>),
    (gi_views, images): (Res<GiViews>, Res<RenderAssets<GpuImage>>),
    queue: Res<RenderQueue>,
) {
    write(view.into_inner(), true, &mut context, volumes, &shown, (&gi_views, &images), &queue);
}

/// Clears the texture, for the deferred pass of the next view or frame.
pub(crate) fn empty_volume(
    view: ViewQuery<Entity>,
    mut context: RenderContext,
    (volumes, shown): (ResMut<Volumes>, Res<ShownVolumes>),
    (gi_views, images): (Res<GiViews>, Res<RenderAssets<GpuImage>>),
    queue: Res<RenderQueue>,
) {
    write(view.into_inner(), false, &mut context, volumes, &shown, (&gi_views, &images), &queue);
}

fn write(
    view: Entity,
    is_light: bool,
    context: &mut RenderContext,
    mut volumes: ResMut<Volumes>,
    shown: &ShownVolumes,
    (gi_views, images): (&GiViews, &RenderAssets<GpuImage>),
    queue: &RenderQueue,
) {
    let Some(view) = gi_views.views.iter().find(|known| known.entity == view) else { return };
    let Some((offer, image)) = shown.0.iter().find(|(offer, _)| offer.key == view.key) else {
        return;
    };
    let Some(image) = images.get(*image) else { return };
    let Some(voxels) = volumes.shown_mut(&view.key) else { return };
    let may_write = |probes: &&mut Probes| !is_light || probes.may_light();
    let Some(probes) = voxels.probes.as_mut().filter(may_write) else { return };
    let device = context.render_device().wgpu_device().clone();
    let mut recorder = Recorder::on(&device, queue, context.command_encoder());
    probes.write(&voxels.gi, (&image.texture_view, &offer.grid), is_light, &mut recorder);
}
