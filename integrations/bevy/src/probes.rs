//! Light for what is drawn forward: transparent things, materials of that method, and all of an app that draws so.
//!
//! Their shaders are Bevy's, which know irradiance volumes (ambient cubes; Mitchell 2006, "Shading in Valve's Source Engine").
//! So the voxels' light is gathered at a grid of probes, some of them in each frame, and written into the texture of such a
//! volume. What is drawn deferred has its own cones, and Bevy's pass for it reads the same texture: so it holds the light only
//! from after that pass to the end of the transparent one, and is black otherwise.

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
use bevy::tasks::Task;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Recorder, storage_buffer,
    uniform_buffer,
};
use lumivox::{GatherPoints, GatherSettings, Gi, GiError, Lights, TraceSettings, wgpu};
use std::any::TypeId;

use crate::settings::{GiVolume, LumivoxGi};
use crate::views::GiViews;
use crate::volumes::{VolumeKey, Volumes};
use crate::voxels::beside_frames;

/// Bevy binds no irradiance volumes in browsers (`IRRADIANCE_VOLUMES_ARE_USABLE`).
pub(crate) const ARE_USABLE: bool = cfg!(not(target_arch = "wasm32"));
/// Voxels along an edge of a probe's cell: of a box, and of the outermost cascade.
const VOXELS_A_CELL: [u32; 2] = [4, 2];
/// Directions of a probe.
const SIDES: u32 = 6;
/// Frames that a probe gathers in its turn.
const FRAMES_A_TURN: u32 = 2;
/// Probes that gather in a frame, by the faces of voxels that do.
const FACES_A_PROBE: u32 = 16;
/// Frames for which probes go on after the last thing drawn forward.
const FRAMES_TO_KEEP: u32 = 120;
/// Frames after which a new texture is on the GPU.
const FRAMES_TO_UPLOAD: u32 = 3;
/// Bytes of `Probe` of `probes.wgsl`.
const PROBE_BYTES: u64 = 112;

/// Probes in the middles of cubic cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct ProbeGrid {
    /// The corner of least coordinates, m.
    low: Vec3,
    /// Edge of a cell, m.
    edge: f32,
    cells: UVec3,
}

impl ProbeGrid {
    /// Around the voxels.
    fn around(gi: &Gi, volume: &GiVolume) -> Self {
        let grid = gi.grid();
        let (min, max) = (grid.min_in_world(), grid.max_in_world());
        let Some(cascades) = volume.cascades() else {
            let edge = VOXELS_A_CELL[0] as f32 * grid.voxel_size_m;
            let cells = ((max - min) / edge - 1e-3).ceil().max(Vec3::ONE).as_uvec3();
            return Self { low: min, edge, cells };
        };
        // In steps of whole cells, so that probes stay where they are while the boxes move.
        let outermost = grid.voxel_size_m * (1 << (cascades.count - 1)) as f32;
        let edge = VOXELS_A_CELL[1] as f32 * outermost;
        let low = (min / edge).floor() * edge;
        Self { low, edge, cells: UVec3::splat(cascades.resolution / VOXELS_A_CELL[1] + 1) }
    }

    fn size(&self) -> Vec3 {
        self.cells.as_vec3() * self.edge
    }

    fn count(&self) -> u32 {
        self.cells.element_product()
    }

    /// Where the other one begins, in cells of this one; `None` if it is of another kind.
    fn shift_to(&self, other: &Self) -> Option<IVec3> {
        let is_alike = self.cells == other.cells && self.edge == other.edge;
        is_alike.then(|| ((other.low - self.low) / self.edge).round().as_ivec3())
    }
}

/// `ProbeSettings` of `probes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct ProbeSettings {
    low: Vec3,
    edge: f32,
    cells: UVec3,
    first: u32,
    texture_low: Vec3,
    texture_edge: f32,
    texture_cells: UVec3,
    count: u32,
    shift: IVec3,
    padding: u32,
}

impl ProbeSettings {
    fn new(grid: &ProbeGrid, texture: &ProbeGrid) -> Self {
        Self {
            low: grid.low,
            edge: grid.edge,
            cells: grid.cells,
            first: 0,
            texture_low: texture.low,
            texture_edge: texture.edge,
            texture_cells: texture.cells,
            count: 0,
            shift: IVec3::ZERO,
            padding: 0,
        }
    }
}

/// What works on probes, of one `Gi`.
#[derive(Clone)]
pub(crate) struct ProbeKernels {
    place: Kernel,
    take: Kernel,
    keep: Kernel,
    move_on: Kernel,
    fill: Kernel,
    empty: Kernel,
    probes_layout: wgpu::BindGroupLayout,
    texture_layout: wgpu::BindGroupLayout,
}

impl ProbeKernels {
    /// Links them; they are compiled once they are needed.
    pub(crate) fn new(gi: &Gi) -> Result<Self, GiError> {
        gi.prepare_gather()?;
        let pipelines = gi.pipelines();
        let mut library = gi.shaders().clone();
        library.add("bevy::probes", include_str!("shaders/probes.wgsl"));
        let probes_layout = LayoutBuilder::compute()
            .uniform()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .storage_mut()
            .build(pipelines, "probes");
        let texture_layout = LayoutBuilder::compute()
            .storage_texture(wgpu::TextureViewDimension::D3, TextureFormat::Rgba16Float)
            .build(pipelines, "texture of probes");
        let kernel = |entry: &str| {
            let layouts = [gi.globals_layout(), &probes_layout, &texture_layout];
            let layouts =
                if matches!(entry, "fill" | "empty") { &layouts[..] } else { &layouts[..2] };
            Kernel::new(pipelines, &library, "bevy::probes", entry, layouts)
        };
        Ok(Self {
            place: kernel("place")?,
            take: kernel("take")?,
            keep: kernel("keep")?,
            move_on: kernel("move_on")?,
            fill: kernel("fill")?,
            empty: kernel("empty")?,
            probes_layout,
            texture_layout,
        })
    }
}

/// The probes of a volume.
pub(crate) struct Probes {
    kernels: ProbeKernels,
    compiling: Option<Task<()>>,
    grid: ProbeGrid,
    points: GatherPoints,
    /// Probes of a turn.
    batch: u32,
    next: u32,
    /// Probes that have gathered since these were made.
    gathered: u32,
    /// For what gathers, and for what is written into the texture.
    turn: [(Buffer, BindGroup); 2],
    texture: Option<(wgpu::TextureView, BindGroup)>,
    frames_unused: u32,
}

impl Probes {
    fn new(kernels: &ProbeKernels, gi: &Gi, gi_settings: &LumivoxGi) -> Self {
        let device = gi.pipelines().device();
        let grid = ProbeGrid::around(gi, &gi_settings.volume);
        let wanted = gi_settings.face_budget().map_or(grid.count(), |faces| faces / FACES_A_PROBE);
        let batch = wanted.clamp(1, grid.count());
        let points = SIDES * batch;
        let [positions, normals] = ["positions of probes", "normals of probes"]
            .map(|label| storage_buffer(device, label, 16 * u64::from(points)));
        let points = GatherPoints::new(device, &positions, &normals, points);
        let [probes, former] = ["probes", "former probes"]
            .map(|label| storage_buffer(device, label, PROBE_BYTES * u64::from(grid.count())));
        let bind = |label: &str| {
            let settings = uniform_buffer(device, label, &ProbeSettings::new(&grid, &grid));
            let group = BindGroupBuilder::new(&kernels.probes_layout)
                .buffer(&settings)
                .buffer(&positions)
                .buffer(&normals)
                .buffer(points.gathered())
                .buffer(&probes)
                .buffer(&former)
                .build(device, label);
            (settings, group)
        };
        let turn = [bind("turn of probes"), bind("texture of probes")];
        let pipelines = gi.pipelines().clone();
        // Beside the frames; there are no probes in browsers, where a task may not block.
        let task = async move { bevy::tasks::block_on(pipelines.compile(&mut |_, _| ())) };
        let compiling = beside_frames(task);
        Self {
            kernels: kernels.clone(),
            compiling: Some(compiling),
            grid,
            points,
            batch,
            next: 0,
            gathered: 0,
            turn,
            texture: None,
            frames_unused: 0,
        }
    }

    /// Whether all of them have gathered.
    fn are_lit(&self) -> bool {
        self.gathered >= self.grid.count()
    }

    /// Makes probes if they are wanted and not there, lets some of them gather, and gives them up when they are not.
    pub(crate) fn record(
        held: &mut Option<Self>,
        kernels: &ProbeKernels,
        (gi, lights): (&Gi, &Lights),
        settings: &LumivoxGi,
        is_wanted: bool,
        recorder: &mut Recorder<'_>,
    ) -> Result<(), GiError> {
        let grid = ProbeGrid::around(gi, &settings.volume);
        let shift = held.as_ref().and_then(|probes| probes.grid.shift_to(&grid));
        if held.is_some() && shift.is_none() {
            *held = None;
        }
        if held.is_none() && is_wanted {
            *held = Some(Self::new(kernels, gi, settings));
        }
        let Some(probes) = held else { return Ok(()) };
        probes.frames_unused = if is_wanted { 0 } else { probes.frames_unused + 1 };
        if probes.frames_unused > FRAMES_TO_KEEP {
            *held = None;
            return Ok(());
        }
        if probes.compiling.as_ref().is_some_and(|compiling| !compiling.is_finished()) {
            return Ok(());
        }
        probes.compiling = None;
        probes.gather(gi, lights, &settings.trace_settings(), (grid, shift), recorder)
    }

    fn gather(
        &mut self,
        gi: &Gi,
        lights: &Lights,
        cones: &TraceSettings,
        (grid, shift): (ProbeGrid, Option<IVec3>),
        recorder: &mut Recorder<'_>,
    ) -> Result<(), GiError> {
        let count = self.grid.count();
        let mut uniform = ProbeSettings::new(&grid, &grid);
        (uniform.first, uniform.count) = (self.next, self.batch);
        uniform.shift = shift.unwrap_or_default();
        let (settings, group) = &self.turn[0];
        recorder.queue().write_buffer(settings, 0, bytemuck::bytes_of(&uniform));
        let groups = [gi.globals(), group];
        if uniform.shift != IVec3::ZERO {
            self.grid = grid;
            self.kernels.keep.run_linear(recorder, &groups, count.into());
            self.kernels.move_on.run_linear(recorder, &groups, count.into());
        }
        self.kernels.place.run_linear(recorder, &groups, self.batch.into());
        self.points.restart(recorder);
        let mut settings = GatherSettings::default();
        settings.cones = *cones;
        settings.frames = FRAMES_A_TURN;
        settings.direct = false;
        gi.record_gather(recorder, &self.points, lights, &settings)?;
        self.kernels.take.run_linear(recorder, &groups, self.batch.into());
        self.next = (self.next + self.batch) % count;
        self.gathered = self.gathered.saturating_add(self.batch).min(count);
        Ok(())
    }

    /// Writes their light into the texture of a grid, or darkness.
    fn write(
        &mut self,
        gi: &Gi,
        (view, grid): (&wgpu::TextureView, &ProbeGrid),
        is_light: bool,
        recorder: &mut Recorder<'_>,
    ) {
        if self.texture.as_ref().is_none_or(|(bound, _)| bound != view) {
            let group = BindGroupBuilder::new(&self.kernels.texture_layout)
                .view(view)
                .build(recorder.device(), "texture of probes");
            self.texture = Some((view.clone(), group));
        }
        let Some((_, texture)) = &self.texture else { return };
        let (settings, group) = &self.turn[1];
        let uniform = ProbeSettings::new(&self.grid, grid);
        recorder.queue().write_buffer(settings, 0, bytemuck::bytes_of(&uniform));
        let kernel = if is_light { &self.kernels.fill } else { &self.kernels.empty };
        let groups = [gi.globals(), group, texture];
        kernel.run_linear(recorder, &groups, grid.count().into());
    }
}

/// What the render world has for the app's world to hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Offer {
    key: VolumeKey,
    grid: ProbeGrid,
    /// cd/m² of the texture's unit.
    unit: f32,
}

impl Offer {
    /// Of voxels that are shown: a single dark cell while nothing is drawn forward, so that Bevy's pipelines, which are others
    /// with irradiance volumes, stay the same.
    pub(crate) fn new(key: VolumeKey, gi: &Gi, probes: Option<&Probes>, unit: f32) -> Self {
        let whole = ProbeGrid { low: gi.grid().min_in_world(), edge: 1.0, cells: UVec3::ONE };
        let grid = probes.filter(|probes| probes.are_lit()).map_or(whole, |probes| probes.grid);
        Self { key, grid, unit }
    }
}

/// Shared by both worlds.
#[derive(Resource, Clone, Default)]
pub(crate) struct Offers(Arc<Mutex<Vec<Offer>>>);

impl Offers {
    pub(crate) fn set(&self, offers: impl Iterator<Item = Offer>) {
        let mut held = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        held.clear();
        held.extend(offers);
    }
}

/// On an irradiance volume of Lumivox's own.
#[derive(Component, Debug)]
pub(crate) struct OwnVolume {
    offer: Offer,
    /// The texture that takes the place of the one that is shown, once it is on the GPU.
    coming: Option<(Offer, Handle<Image>, u32)>,
}

/// Makes Bevy's irradiance volumes for what is offered.
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
    for offer in offers.iter().filter(|offer| !known.contains(&offer.key)) {
        let voxels = images.add(texture(&offer.grid));
        let volume = IrradianceVolume { voxels, intensity: offer.unit, ..default() };
        let own = OwnVolume { offer: *offer, coming: None };
        let everywhere = RenderLayers::from_layers(&std::array::from_fn::<usize, 64, _>(|n| n));
        commands.spawn((
            (own, volume, LightProbe::new(), place(offer)),
            (NoFrustumCulling, everywhere, Name::new("Lumivox")),
        ));
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

/// Lets each camera see the irradiance volume of its own voxels alone, and others none of them: after Bevy has looked for what
/// cameras see.
pub(crate) fn choose_volumes(
    mut cameras: Query<(Entity, &mut VisibleEntities, Option<&LumivoxGi>), With<Camera3d>>,
    own: Query<&OwnVolume>,
    all: Query<(), With<IrradianceVolume>>,
) {
    let class = TypeId::of::<ClusterVisibilityClass>();
    for (camera, mut visible, gi) in &mut cameras {
        if !visible.entities.contains_key(&class) {
            continue;
        }
        let key = gi.map(|gi| VolumeKey::new(&gi.volume, camera));
        let is_there = key.is_some_and(|key| own.iter().any(|own| own.offer.key == key));
        visible.get_mut(class).retain(|entity| match own.get(*entity) {
            Ok(own) => Some(own.offer.key) == key,
            // Nothing stops the light of the app's own.
            Err(_) => !(is_there && all.contains(*entity)),
        });
    }
}

/// The irradiance volumes of Lumivox's own, as the app's world has them in this frame.
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

/// What is drawn forward in this frame.
#[derive(SystemParam)]
pub(crate) struct Forward<'w> {
    opaque: Res<'w, ViewBinnedRenderPhases<Opaque3d>>,
    masked: Res<'w, ViewBinnedRenderPhases<AlphaMask3d>>,
    transmissive: Res<'w, ViewSortedRenderPhases<Transmissive3d>>,
    transparent: Res<'w, ViewSortedRenderPhases<Transparent3d>>,
}

impl Forward<'_> {
    /// Whether a view has any of it.
    pub(crate) fn is_in(&self, view: &ExtractedView) -> bool {
        let key = &view.retained_view_entity;
        self.opaque.get(key).is_some_and(|phase| !phase.is_empty())
            || self.masked.get(key).is_some_and(|phase| !phase.is_empty())
            || self.transmissive.get(key).is_some_and(|phase| !phase.items.is_empty())
            || self.transparent.get(key).is_some_and(|phase| !phase.items.is_empty())
    }
}

/// Light for what is drawn forward from now on.
pub(crate) fn fill_volume(
    view: ViewQuery<Entity>,
    mut context: RenderContext,
    (volumes, shown): (ResMut<Volumes>, Res<ShownVolumes>),
    (gi_views, images): (Res<GiViews>, Res<RenderAssets<GpuImage>>),
    queue: Res<RenderQueue>,
) {
    write(view.into_inner(), true, &mut context, volumes, &shown, (&gi_views, &images), &queue);
}

/// Darkness for what is drawn deferred in the next view, or frame.
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
    let Some(probes) = voxels.probes.as_mut().filter(|probes| probes.are_lit()) else { return };
    let device = context.render_device().wgpu_device().clone();
    let mut recorder = Recorder::on(&device, queue, context.command_encoder());
    probes.write(&voxels.gi, (&image.texture_view, &offer.grid), is_light, &mut recorder);
}
