//! The voxels: made in the background, filled and lit in each frame without waiting.

use bevy::prelude::*;
use bevy::render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy::render::renderer::{PendingCommandBuffers, RenderDevice, RenderQueue};
use bevy::tasks::futures::check_ready;
use bevy::tasks::{AsyncComputeTaskPool, Task};
use lumivox::gpu::{Pipelines, Recorder};
use lumivox::{EnvironmentLight, Gi, GiConfig, GiError, Grid, Light, Lights, wgpu};

use crate::compose::Compose;
use crate::geometry::SceneGeometry;
use crate::gbuffer;
use crate::instances::Instances;
use crate::lights::{SceneLights, scaled};
use crate::report::{LumivoxEvent, Reports};
use crate::settings::{GiVolume, LumivoxGi};
use crate::views::{GiView, GiViews};

/// Frames in which new voxels are lit before they are shown.
const FRAMES_TO_LIGHT: u32 = 8;
/// Frames for which a volume that no camera uses is kept.
const FRAMES_TO_KEEP: u32 = 120;
/// How far meshes may reach out of a box that was fitted to them, as a share of its longest edge, before it is fitted anew.
const TOLERATED_GROWTH: f32 = 0.01;
/// How much smaller than its box the scene may become before it is fitted anew.
const TOLERATED_SHRINKING: f32 = 0.4;

/// What cameras must have in common to share a volume.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct VolumeKey {
    volume: GiVolume,
    /// Cascades follow one camera.
    camera: Option<Entity>,
}

impl VolumeKey {
    pub(crate) fn new(volume: &GiVolume, camera: Entity) -> Self {
        Self { volume: *volume, camera: volume.cascades().map(|_| camera) }
    }
}

/// Voxels with their light.
pub(crate) struct Voxels {
    pub(crate) gi: Gi,
    pub(crate) lights: Lights,
    pub(crate) compose: Compose,
    /// Another number for each of them.
    pub(crate) number: u64,
    /// What the lights were set to.
    lit_by: (Vec<Light>, Vec3),
    /// The geometry that they were made of.
    version: Option<u64>,
    is_late: bool,
    frames_lit: u32,
    /// The box that the scene was in when they were fitted to it.
    fitted: Option<[Vec3; 2]>,
    /// A version of the geometry that is refused.
    refused: Option<u64>,
}

/// A volume, and the one that takes its place.
struct Held {
    key: VolumeKey,
    shown: Option<Box<Voxels>>,
    coming: Option<Box<Voxels>>,
    making: Option<(Task<Result<Made, GiError>>, Option<[Vec3; 2]>)>,
    /// What could not be made, so that it is not tried in each frame.
    failed: Option<Option<[Vec3; 2]>>,
    unused: u32,
}

/// What a task makes.
struct Made {
    gi: Gi,
    compose: Compose,
}

/// All of them.
#[derive(Resource, Default)]
pub(crate) struct Volumes {
    held: Vec<Held>,
    pipelines: Option<Pipelines>,
    numbers: u64,
    /// cd/m² of Lumivox's unit of radiance: a power of two, so that half floats hold the pictures of this exposure.
    unit: f32,
    /// Of the first camera.
    exposure: f32,
    /// Shared scratch for the lights of a frame.
    lights: Vec<Light>,
}

impl Volumes {
    /// The voxels to be seen through a key, if they are ready.
    pub(crate) fn shown(&self, key: &VolumeKey) -> Option<&Voxels> {
        self.held.iter().find(|held| held.key == *key)?.shown.as_deref()
    }

    pub(crate) fn pipelines(&mut self, device: &RenderDevice) -> Pipelines {
        self.pipelines.get_or_insert_with(|| Pipelines::new(device.wgpu_device())).clone()
    }

    pub(crate) fn unit(&self) -> f32 {
        if self.unit > 0.0 { self.unit } else { 1.0 }
    }

    /// The exposure that emission is seen with.
    pub(crate) fn exposure(&self) -> f32 {
        if self.exposure > 0.0 { self.exposure } else { 1.0 }
    }

    /// Chooses the unit of radiance; whether it or the exposure is another is returned.
    pub(crate) fn choose_unit(&mut self, views: &[GiView]) -> bool {
        let Some(view) = views.first() else { return false };
        let exposure = view.exposure;
        if !(exposure > 0.0 && exposure.is_finite()) || exposure == self.exposure {
            return false;
        }
        self.exposure = exposure;
        // A picture's white is 1 / exposure. The unit stays while that is within four stops.
        let stops = (1.0 / exposure).log2();
        if self.unit <= 0.0 || (stops - self.unit.log2()).abs() > 4.0 {
            self.unit = stops.round().exp2();
        }
        true
    }

    /// Bytes on the GPU, of all volumes.
    pub(crate) fn bytes(&self) -> u64 {
        let voxels = self.held.iter().flat_map(|held| held.shown.iter().chain(&held.coming));
        voxels.flat_map(|voxels| voxels.gi.memory()).map(|(_, bytes)| bytes).sum()
    }

    /// Finds or begins the volumes that cameras need, and gives up those that none does.
    pub(crate) fn follow(
        &mut self,
        views: &[GiView],
        instances: &Instances,
        (device, queue): (&RenderDevice, &wgpu::Queue),
        reports: &Reports,
    ) {
        for held in &mut self.held {
            held.unused += 1;
        }
        for view in views {
            if !self.held.iter().any(|held| held.key == view.key) {
                self.held.push(Held::new(view.key));
            }
            let pipelines = self.pipelines(device);
            let ambient = view.ambient / self.unit();
            let Some(held) = self.held.iter_mut().find(|held| held.key == view.key) else { continue };
            if std::mem::take(&mut held.unused) > 0 {
                held.make(view, instances, (&pipelines, queue), reports);
            }
            held.take_made(&mut self.numbers, ambient, reports);
        }
        self.held.retain(|held| held.unused < FRAMES_TO_KEEP);
    }
}

impl Held {
    fn new(key: VolumeKey) -> Self {
        Self { key, shown: None, coming: None, making: None, failed: None, unused: 1 }
    }

    /// Begins to make voxels if there are none, or if the scene has outgrown them.
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
        match grid(&view.gi.volume, bounds, view.position) {
            Ok(grid) => {
                let task = make(pipelines, queue, grid, view.gi);
                self.making = Some((task, bounds));
            }
            Err(error) => self.fail(&error, bounds, reports),
        }
    }

    fn fail(&mut self, error: &GiError, bounds: Option<[Vec3; 2]>, reports: &Reports) {
        self.failed = Some(bounds);
        reports.tell(LumivoxEvent::Failed { error: error.to_string() });
    }

    /// Takes what a task has made.
    fn take_made(&mut self, numbers: &mut u64, ambient: Vec3, reports: &Reports) {
        let Some((task, bounds)) = &mut self.making else { return };
        let bounds = *bounds;
        let Some(made) = check_ready(task) else { return };
        self.making = None;
        match made {
            Ok(Made { gi, compose }) => {
                *numbers += 1;
                let lights = gi.bind_lights(&[], ambient, None);
                self.coming = Some(Box::new(Voxels {
                    gi,
                    lights,
                    compose,
                    number: *numbers,
                    lit_by: (Vec::new(), ambient),
                    version: None,
                    is_late: false,
                    frames_lit: 0,
                    fitted: bounds,
                    refused: None,
                }));
            }
            Err(error) => self.fail(&error, bounds, reports),
        }
    }
}

/// Whether a scene needs another box than the one that was fitted to it.
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
            // A scene that is a single plane has a box, too.
            let least = 1e-3 * (max - min).max_element().max(1e-3);
            Grid::fit(min, max.max(min + least), resolution, Vec3::ZERO)
        }
        (GiVolume::Scene { resolution }, None) => Grid::fit(Vec3::ZERO, Vec3::ONE, resolution, Vec3::ZERO),
        (GiVolume::Cascades { .. }, _) => {
            let options = volume.cascades().unwrap_or_default();
            Grid::cascades(camera, &options, Vec3::ZERO)
        }
    }
}

/// Makes voxels and compiles what works on them, beside the frames.
fn make(
    pipelines: &Pipelines,
    queue: &wgpu::Queue,
    grid: Grid,
    settings: LumivoxGi,
) -> Task<Result<Made, GiError>> {
    let (pipelines, queue) = (pipelines.clone(), queue.clone());
    let link = move || -> Result<(Pipelines, Made), GiError> {
        let config = GiConfig { gbuffer: Some(gbuffer::module()), ..GiConfig::new(grid) };
        let gi = Gi::with_pipelines(&pipelines, &queue, config)?;
        // Kernels of these settings are compiled with all others.
        gi.targets(UVec2::splat(8), &settings.trace_settings());
        let compose = Compose::new(&gi)?;
        Ok((pipelines, Made { gi, compose }))
    };
    #[cfg(not(target_arch = "wasm32"))]
    let task = async move {
        let (pipelines, made) = link()?;
        bevy::tasks::block_on(pipelines.compile(&mut |_, _| ()));
        Ok(made)
    };
    #[cfg(target_arch = "wasm32")]
    let task = async move {
        let (pipelines, made) = link()?;
        pipelines.compile(&mut |_, _| ()).await;
        Ok(made)
    };
    AsyncComputeTaskPool::get().spawn(task)
}

/// Records the work of all volumes, before that of the cameras.
pub(crate) fn record_volumes(
    mut volumes: ResMut<Volumes>,
    views: Res<GiViews>,
    scene: Res<SceneGeometry>,
    scene_lights: Res<SceneLights>,
    instances: Res<Instances>,
    (device, queue): (Res<RenderDevice>, Res<RenderQueue>),
    diagnostics: Option<Res<DiagnosticsRecorder>>,
    mut pending: ResMut<PendingCommandBuffers>,
    reports: Res<Reports>,
) {
    let volumes = &mut *volumes;
    let share = 1.0 / volumes.unit();
    volumes.lights.clear();
    volumes.lights.extend(scene_lights.lights.iter().map(|light| scaled(*light, share)));
    for held in volumes.held.iter_mut().filter(|held| held.unused == 0) {
        let Some(view) = views.views.iter().find(|view| view.key == held.key) else { continue };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor {
            label: Some("lumivox voxels"),
        });
        let frame = Frame {
            view,
            scene: &scene,
            has_deforming: instances.has_deforming,
            lights: &volumes.lights,
            ambient: view.ambient * share,
            diagnostics: diagnostics.as_deref(),
        };
        let mut is_recorded = false;
        for voxels in held.shown.iter_mut().chain(&mut held.coming) {
            match voxels.record((&device, &queue), &mut encoder, &frame) {
                Ok(recorded) => is_recorded |= recorded,
                Err(error) => reports.tell(LumivoxEvent::Failed { error: error.to_string() }),
            }
        }
        if is_recorded {
            pending.push_encoder(encoder, "lumivox voxels");
        }
        if held.coming.as_ref().is_some_and(|coming| coming.is_lit()) {
            if held.shown.is_none() {
                reports.tell(LumivoxEvent::Ready);
            }
            held.shown = held.coming.take();
        }
    }
}

/// What a frame does to voxels.
struct Frame<'a> {
    view: &'a GiView,
    scene: &'a SceneGeometry,
    has_deforming: bool,
    lights: &'a [Light],
    ambient: Vec3,
    diagnostics: Option<&'a DiagnosticsRecorder>,
}

impl Voxels {
    /// Whether they may be seen.
    fn is_lit(&self) -> bool {
        self.gi.voxels().is_some() && !self.is_late && self.frames_lit >= FRAMES_TO_LIGHT
    }

    /// Follows geometry and lights. Whether anything was recorded is returned.
    fn record(
        &mut self,
        (device, queue): (&RenderDevice, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<bool, GiError> {
        let version = frame.scene.version;
        if self.refused == Some(version) {
            return Ok(false);
        }
        if self.lit_by.0 != frame.lights || self.lit_by.1 != frame.ambient {
            self.lit_by.0.clear();
            self.lit_by.0.extend_from_slice(frame.lights);
            self.lit_by.1 = frame.ambient;
            let environment = EnvironmentLight::from(frame.ambient);
            self.lights.update(queue, frame.lights, environment, None);
        }
        let moves = frame.view.gi.volume.cascades().is_some() && self.gi.center_on(frame.view.position)?;
        let is_due = self.version != Some(version) || frame.has_deforming || self.is_late || moves;
        if is_due {
            let span = frame.diagnostics.map(|to| to.time_span(encoder, "lumivox/voxelize"));
            let mut recorder = Recorder::on(device.wgpu_device(), queue, encoder);
            let voxelized = self.gi.voxelize_frame(&mut recorder, &frame.scene.geometry);
            drop(recorder);
            if let Some(span) = span {
                span.end(encoder);
            }
            match voxelized {
                Ok(voxelized) => self.is_late = voxelized.is_late,
                Err(error) => {
                    self.refused = Some(version);
                    return Err(error);
                }
            }
            self.version = Some(version);
        }
        if self.gi.voxels().is_none() {
            return Ok(is_due);
        }
        let span = frame.diagnostics.map(|to| to.time_span(encoder, "lumivox/light"));
        let mut recorder = Recorder::on(device.wgpu_device(), queue, encoder);
        let settings = frame.view.gi.trace_settings();
        let lit = self.gi.light_frame(&mut recorder, &self.lights, frame.view.gi.face_budget(), &settings);
        drop(recorder);
        if let Some(span) = span {
            span.end(encoder);
        }
        lit?;
        self.frames_lit = self.frames_lit.saturating_add(1);
        Ok(true)
    }
}
