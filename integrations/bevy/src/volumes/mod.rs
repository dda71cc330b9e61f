//! Manages the volumes of all cameras: makes them, shows them once their voxels are ready, replaces
//! and drops them.

pub(crate) mod voxels;

use std::ops::RangeInclusive;

use bevy::pbr::{ViewLightEntities, ViewShadowBindings};
use bevy::prelude::*;
use bevy::render::diagnostic::DiagnosticsRecorder;
use bevy::render::render_asset::RenderAssets;
use bevy::render::renderer::{RenderContext, RenderDevice, RenderQueue, ViewQuery};
use bevy::render::texture::GpuImage;
use bevy::render::view::ExtractedView;
use bevy::tasks::Task;
use bevy::tasks::futures::check_ready;
use lumivox::gpu::{Pipelines, Recorder};
use lumivox::{GiError, Grid, Light, wgpu};

use crate::light::irradiance::{ARE_USABLE, Forward, Offer};
use crate::light::lights::{SceneLights, scaled};
use crate::light::shadows::{BevyShadows, ShadowMaps};
use crate::light::surroundings::Surroundings;
use crate::report::{LumivoxEvent, Reports};
use crate::scene::ChangedImages;
use crate::scene::deform::{Deformer, ScenePoses};
use crate::scene::geometry::SceneGeometry;
use crate::scene::instances::Instances;
use crate::screen::views::{GiView, GiViews};
use crate::settings::{GiVolume, LumivoxGi};
use crate::volumes::voxels::{Frame, Made, Voxels, make};

/// Frames that an unused volume is kept.
const FRAMES_TO_KEEP: u32 = 120;
/// Frames that an unused volume is kept if it has never been shown.
const FRAMES_TO_WAIT: u32 = 30;
/// Frames for which the light of an unused volume may still be shown.
const FRAMES_TO_TRUST: u32 = 8;
/// How far meshes may extend beyond the box that was fitted to them, as a share of its longest
/// edge, before it is fitted again.
const TOLERATED_GROWTH: f32 = 0.01;
/// Size of the scene, as a share of the box, below which the box is fitted again.
const TOLERATED_SHRINKING: f32 = 0.4;
/// Lumivox's unit of radiance in nearly all scenes, cd/m².
const USUAL_UNIT: f32 = 1024.0;
/// Allowed radiance of a picture's white, in Lumivox's unit. Radiance is stored in half floats:
/// within this range they have 32 steps for a thousandth of white, and headroom for lamps a
/// thousand times as bright. With the usual unit the range is EV100 1 to 15.7.
const HELD_WHITES: RangeInclusive<f32> = 1.0 / 512.0..=64.0;

/// Identifies a volume: cameras with equal keys share one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VolumeKey {
    volume: GiVolume,
    /// The camera that cascades are centred on; `None` for boxes.
    camera: Option<Entity>,
}

impl VolumeKey {
    pub(crate) fn new(volume: &GiVolume, camera: Entity) -> Self {
        Self { volume: *volume, camera: volume.cascades().map(|_| camera) }
    }
}

/// A volume, and its replacement while that is being made.
struct Held {
    key: VolumeKey,
    shown: Option<Box<Voxels>>,
    coming: Option<Box<Voxels>>,
    making: Option<(Task<Result<Made, GiError>>, Option<[Vec3; 2]>)>,
    /// Bounds of the failed attempt, so that it is not repeated every frame.
    failed: Option<Option<[Vec3; 2]>>,
    unused: u32,
    /// Whether the volume was recorded in this frame.
    is_recorded: bool,
    /// Shadow maps of the first of its cameras: each camera has its own cascades of a sun.
    shadow_maps: ShadowMaps,
}

/// All volumes.
#[derive(Resource, Default)]
pub(crate) struct Volumes {
    held: Vec<Held>,
    pipelines: Option<Pipelines>,
    numbers: u64,
    /// Lumivox's unit of radiance, cd/m²; a power of two. Half floats store radiance in it.
    unit: f32,
    /// Exposure of the first camera.
    exposure: f32,
    is_exposure_changed: bool,
    /// Scratch for the lights of a frame.
    lights: Vec<Light>,
}

impl Volumes {
    /// The shown voxels of a volume; `None` until they are ready.
    pub(crate) fn shown(&self, key: &VolumeKey) -> Option<&Voxels> {
        self.held.iter().find(|held| held.key == *key)?.shown.as_deref()
    }

    pub(crate) fn shown_mut(&mut self, key: &VolumeKey) -> Option<&mut Voxels> {
        self.held.iter_mut().find(|held| held.key == *key)?.shown.as_deref_mut()
    }

    /// Light for forward draws, from all shown voxels in use.
    pub(crate) fn offers(&self) -> impl Iterator<Item = Offer> {
        let unit = self.unit();
        let in_use = self.held.iter().filter(|held| held.unused <= FRAMES_TO_TRUST);
        in_use.filter_map(move |held| {
            let voxels = held.shown.as_deref()?;
            Some(Offer::new(held.key, &voxels.gi, voxels.probes.as_ref(), unit))
        })
    }

    pub(crate) fn pipelines(&mut self, device: &RenderDevice) -> Pipelines {
        self.pipelines.get_or_insert_with(|| Pipelines::new(device.wgpu_device())).clone()
    }

    pub(crate) fn unit(&self) -> f32 {
        if self.unit > 0.0 { self.unit } else { 1.0 }
    }

    /// The exposure of the first camera; 1 until it is known.
    pub(crate) fn exposure(&self) -> f32 {
        if self.exposure > 0.0 { self.exposure } else { 1.0 }
    }

    /// Tracks the exposure of the first camera. If the unit of radiance no longer suits its
    /// pictures, chooses another unit and drops all voxels, to be made again.
    pub(crate) fn follow_exposure(&mut self, views: &[GiView]) {
        let Some(view) = views.first() else { return };
        let exposure = view.exposure;
        if !(exposure > 0.0 && exposure.is_finite()) || exposure == self.exposure {
            return;
        }
        self.exposure = exposure;
        self.is_exposure_changed = true;
        let white = 1.0 / exposure;
        if self.unit <= 0.0 || !HELD_WHITES.contains(&(white / self.unit)) {
            let is_usual = HELD_WHITES.contains(&(white / USUAL_UNIT));
            self.unit = if is_usual { USUAL_UNIT } else { white.log2().round().exp2() };
            self.held.clear();
        }
    }

    /// Whether the exposure or the unit has changed since the last call.
    pub(crate) fn take_exposure_changed(&mut self) -> bool {
        std::mem::take(&mut self.is_exposure_changed)
    }

    /// Whether there are no volumes.
    pub(crate) fn are_gone(&self) -> bool {
        self.held.is_empty()
    }

    /// Updates or starts the volumes that cameras need, and drops those that stay unused.
    pub(crate) fn follow(
        &mut self,
        views: &[GiView],
        instances: &Instances,
        (device, queue): (&RenderDevice, &wgpu::Queue),
        reports: &Reports,
    ) {
        for held in &mut self.held {
            held.unused += 1;
            held.is_recorded = false;
        }
        let pipelines = self.pipelines(device);
        let unit = self.unit();
        for view in views {
            if !self.held.iter().any(|held| held.key == view.wanted) {
                self.held.push(Held::new(view.wanted, device.wgpu_device()));
            }
            let is_of_view = |held: &&mut Held| held.key == view.key || held.key == view.wanted;
            for held in self.held.iter_mut().filter(is_of_view) {
                let unused = std::mem::take(&mut held.unused);
                if unused == 0 {
                    // It was already updated in this frame for another camera that shares it.
                    continue;
                }
                if unused > FRAMES_TO_TRUST && held.key != view.key {
                    held.light_anew();
                }
                held.make(view, instances, (&pipelines, queue), reports);
                held.take_made(&mut self.numbers, view.ambient / unit, reports);
                held.show(reports);
            }
        }
        self.held.retain(|held| {
            let frames = if held.shown.is_some() { FRAMES_TO_KEEP } else { FRAMES_TO_WAIT };
            held.unused < frames
        });
    }
}

impl Held {
    fn new(key: VolumeKey, device: &wgpu::Device) -> Self {
        Self {
            key,
            shown: None,
            coming: None,
            making: None,
            failed: None,
            unused: 1,
            is_recorded: false,
            shadow_maps: ShadowMaps::none(device),
        }
    }

    /// Starts to make voxels if there are none, or if the scene no longer fits them.
    fn make(
        &mut self,
        view: &GiView,
        instances: &Instances,
        (pipelines, queue): (&Pipelines, &wgpu::Queue),
        reports: &Reports,
    ) {
        if self.making.is_some() || self.coming.is_some() {
            return;
        }
        let fits_scene = matches!(self.key.volume, GiVolume::Scene { .. });
        let bounds = fits_scene.then(|| instances.bounds()).flatten();
        let is_wanted = match (&self.shown, bounds) {
            (None, None) => !fits_scene,
            (None, Some(_)) => true,
            (Some(voxels), Some(bounds)) => {
                voxels.fitted.is_some_and(|fitted| has_outgrown(fitted, bounds))
            }
            (Some(_), None) => false,
        };
        if !is_wanted || self.failed == Some(bounds) {
            return;
        }
        match grid(&self.key.volume, bounds, view.position) {
            Ok(grid) => {
                let gi = LumivoxGi { volume: self.key.volume, ..view.gi };
                let task = make(pipelines, queue, grid, gi);
                self.making = Some((task, bounds));
            }
            Err(error) => self.fail(&error, bounds, reports),
        }
    }

    /// Hides voxels with stale light until they are lit again.
    fn light_anew(&mut self) {
        if let Some(mut stale) = self.shown.take() {
            stale.light_anew();
            self.coming.get_or_insert(stale);
        }
    }

    /// Shows new voxels once they are lit.
    fn show(&mut self, reports: &Reports) {
        if self.coming.as_ref().is_some_and(|coming| coming.is_lit()) {
            if self.shown.is_none() {
                reports.tell(LumivoxEvent::Ready);
            }
            self.shown = self.coming.take();
        }
    }

    fn fail(&mut self, error: &GiError, bounds: Option<[Vec3; 2]>, reports: &Reports) {
        self.failed = Some(bounds);
        reports.tell(LumivoxEvent::Failed { error: error.to_string() });
    }

    /// Applies the result of the task once it is finished.
    fn take_made(&mut self, numbers: &mut u64, ambient: Vec3, reports: &Reports) {
        let Some((task, bounds)) = &mut self.making else { return };
        let bounds = *bounds;
        let Some(made) = check_ready(task) else { return };
        self.making = None;
        match made {
            Ok(made) => {
                *numbers += 1;
                let with = (ambient, &self.shadow_maps);
                self.coming = Some(Box::new(Voxels::new(made, *numbers, with, bounds)));
            }
            Err(error) => self.fail(&error, bounds, reports),
        }
    }
}

/// Whether the box that was fitted to a scene has to be fitted again.
fn has_outgrown([min, max]: [Vec3; 2], [low, high]: [Vec3; 2]) -> bool {
    let longest = (max - min).max_element();
    let beyond = (min - low).max(high - max).max_element();
    beyond > TOLERATED_GROWTH * longest
        || (high - low).max_element() < TOLERATED_SHRINKING * longest
}

fn grid(volume: &GiVolume, bounds: Option<[Vec3; 2]>, camera: Vec3) -> Result<Grid, GiError> {
    match (*volume, bounds) {
        (GiVolume::Box { min, max, resolution }, _) => Grid::fit(min, max, resolution, Vec3::ZERO),
        (GiVolume::Scene { resolution }, Some([min, max])) => {
            // A flat scene still gets a box with a volume.
            let least = 1e-3 * (max - min).max_element().max(1e-3);
            Grid::fit(min, max.max(min + least), resolution, Vec3::ZERO)
        }
        (GiVolume::Scene { resolution }, None) => {
            Grid::fit(Vec3::ZERO, Vec3::ONE, resolution, Vec3::ZERO)
        }
        (GiVolume::Cascades { .. }, _) => {
            let options = volume.cascades().unwrap_or_default();
            Grid::cascades(camera, &options, Vec3::ZERO)
        }
    }
}

/// Records the work of a camera's volume once per frame, after the shadow maps of the first camera
/// that shares it.
pub(crate) fn record_volume(
    view: ViewQuery<(Entity, Option<(&ViewShadowBindings, &ViewLightEntities)>)>,
    extracted: Query<&ExtractedView>,
    mut context: RenderContext,
    mut volumes: ResMut<Volumes>,
    (gi_views, scene, mut scene_lights): (Res<GiViews>, Res<SceneGeometry>, ResMut<SceneLights>),
    (mut deformer, poses): (ResMut<Deformer>, Res<ScenePoses>),
    (shadows, images, forward): (BevyShadows, Res<RenderAssets<GpuImage>>, Forward),
    changed_images: Res<ChangedImages>,
    queue: Res<RenderQueue>,
    diagnostics: Option<Res<DiagnosticsRecorder>>,
    reports: Res<Reports>,
) {
    let (entity, maps) = view.into_inner();
    let Some(view) = gi_views.views.iter().find(|view| view.entity == entity) else { return };
    let device = context.render_device().wgpu_device().clone();
    let volumes = &mut *volumes;
    let share = 1.0 / volumes.unit();
    let map = view.surroundings.and_then(|surroundings| match surroundings.cube(&images) {
        Ok(cube) => Some((cube?, surroundings)),
        Err(missing) => {
            reports.once(LumivoxEvent::Unsupported { missing: missing.to_owned() });
            None
        }
    });
    let redrawn = changed_images.due();
    let is_redrawn =
        |surroundings: &Surroundings| redrawn.is_some_and(|images| surroundings.is_of(images));
    let is_map_redrawn = map.as_ref().is_some_and(|(_, surroundings)| is_redrawn(surroundings));
    if let Some(pipelines) = &volumes.pipelines {
        let mut recorder = Recorder::on(&device, &queue, context.command_encoder());
        if let Err(error) = deformer.record(pipelines, &mut recorder, &poses) {
            reports.once(LumivoxEvent::Failed { error: error.to_string() });
        }
    }
    let is_of_view = |held: &&mut Held| held.key == view.key || held.key == view.wanted;
    for held in volumes.held.iter_mut().filter(is_of_view) {
        if std::mem::replace(&mut held.is_recorded, true) {
            continue;
        }
        if let Some(maps) = maps {
            held.shadow_maps.follow((&device, &queue), maps, &shadows, &mut scene_lights.lights);
        }
        volumes.lights.clear();
        volumes.lights.extend(scene_lights.lights.iter().map(|light| scaled(light.light, share)));
        let shares = |other: &&GiView| other.key == held.key || other.wanted == held.key;
        let has_forward = gi_views.views.iter().filter(shares).any(|other| {
            extracted.get(other.entity).is_ok_and(|extracted| forward.is_in(extracted))
        });
        if has_forward && !ARE_USABLE {
            reports.once(LumivoxEvent::ForwardNotLit);
        }
        let frame = Frame {
            gi: LumivoxGi { volume: held.key.volume, ..view.gi },
            position: view.position,
            is_map_redrawn,
            map: map.as_ref().map(|(cube, surroundings)| (cube, surroundings)),
            share,
            scene: &scene,
            lights: &volumes.lights,
            shadow_maps: &held.shadow_maps,
            ambient: view.ambient * share,
            has_forward,
            diagnostics: diagnostics.as_deref(),
        };
        for voxels in held.shown.iter_mut().chain(&mut held.coming) {
            if let Err(error) = voxels.record((&device, &queue), context.command_encoder(), &frame)
            {
                reports.tell(LumivoxEvent::Failed { error: error.to_string() });
            }
        }
    }
}
