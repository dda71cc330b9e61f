//! The voxels of a volume: made in the background, then filled and lit every frame without waiting.

use bevy::prelude::*;
use bevy::render::diagnostic::{DiagnosticsRecorder, RecordDiagnostics};
use bevy::tasks::{AsyncComputeTaskPool, Task};
use lumivox::gpu::{Pipelines, Recorder};
use lumivox::hooks::Resource as Bound;
use lumivox::{
    CubeUse, EnvironmentCube, EnvironmentLight, Geometry, Gi, GiConfig, GiError, Grid, Light,
    Lights, Shadow, ShadowSource, VolumeKind, wgpu,
};

use crate::light::irradiance::ARE_USABLE;
use crate::light::probes::{ProbeKernels, Probes};
use crate::light::shadows::{self, ShadowMaps};
use crate::light::surroundings::{EDGE, Surroundings};
use crate::scene::geometry::SceneGeometry;
use crate::screen::compose::Compose;
use crate::screen::gbuffer;
use crate::settings::LumivoxGi;

/// Frames in which new voxels are lit before they are shown.
const FRAMES_TO_LIGHT: u32 = 8;
/// Frames after a change at which lights with shadow maps are evaluated again: Bevy draws a map
/// only once its pipelines are compiled, and sends no event then.
const FRAMES_OF_NEW_MAPS: [u32; 3] = [2, 16, 120];

/// Voxels with their light.
pub(crate) struct Voxels {
    pub(crate) gi: Gi,
    pub(crate) lights: Lights,
    pub(crate) compose: Compose,
    /// A unique number.
    pub(crate) number: u64,
    lit_by: LitBy,
    cube: EnvironmentCube,
    /// The environment map that was copied to `cube`.
    taken: Option<(wgpu::TextureView, CubeUse)>,
    frames_taken: u32,
    /// Version of the geometry that was voxelized last.
    version: Option<u64>,
    is_late: bool,
    frames_lit: u32,
    /// Frames since lights or geometry have changed.
    frames_at_rest: u32,
    /// The bounds of the scene that the volume was fitted to.
    pub(crate) fitted: Option<[Vec3; 2]>,
    /// Probes that light forward draws; `None` if there are no such draws.
    pub(crate) probes: Option<Probes>,
    probe_kernels: Option<ProbeKernels>,
}

/// The values that the lights were set from.
struct LitBy {
    lights: Vec<Light>,
    ambient: Vec3,
    /// True if the surroundings are an environment map.
    has_map: bool,
    shadow_maps: Option<[Bound; 4]>,
}

/// The result of the task of [`make`].
pub(crate) struct Made {
    gi: Gi,
    cube: EnvironmentCube,
    compose: Compose,
    probe_kernels: Option<ProbeKernels>,
}

/// The inputs of a frame.
pub(crate) struct Frame<'a> {
    /// Settings of the first camera that shares these voxels, with the voxels' own volume.
    pub(crate) gi: LumivoxGi,
    /// That camera's position, which cascades are centred on.
    pub(crate) position: Vec3,
    /// The environment map, if it is loaded.
    pub(crate) map: Option<(&'a wgpu::TextureView, &'a Surroundings)>,
    /// Whether the map's content has changed.
    pub(crate) is_map_redrawn: bool,
    /// 1 cd/m² in Lumivox's unit of radiance.
    pub(crate) share: f32,
    pub(crate) scene: &'a SceneGeometry,
    pub(crate) lights: &'a [Light],
    pub(crate) shadow_maps: &'a ShadowMaps,
    /// The ambient light in Lumivox's unit.
    pub(crate) ambient: Vec3,
    /// Whether anything is drawn forward.
    pub(crate) has_forward: bool,
    pub(crate) diagnostics: Option<&'a DiagnosticsRecorder>,
}

impl Frame<'_> {
    fn has_mapped_lights(&self) -> bool {
        self.lights.iter().any(|light| matches!(light.shadow, Shadow::Map { .. }))
    }
}

/// Makes voxels and compiles their pipelines, in the background.
pub(crate) fn make(
    pipelines: &Pipelines,
    queue: &wgpu::Queue,
    grid: Grid,
    settings: LumivoxGi,
) -> Task<Result<Made, GiError>> {
    let (pipelines, queue) = (pipelines.clone(), queue.clone());
    let link = move || -> Result<(Pipelines, Made), GiError> {
        let volume = match settings.volume.cascades() {
            Some(_) => VolumeKind::Cascades,
            None => VolumeKind::Dense,
        };
        let config = GiConfig {
            volume,
            gbuffer: Some(gbuffer::module()),
            shadow_maps: Some(shadows::module()),
            ..GiConfig::new(grid)
        };
        let gi = Gi::with_pipelines(&pipelines, &queue, config)?;
        gi.prepare(&Geometry::default(), 1, true, &settings.trace_settings())?;
        let compose = Compose::new(&gi)?;
        let cube = EnvironmentCube::new(&pipelines, gi.shaders(), EDGE)?;
        Ok((pipelines, Made { gi, cube, compose, probe_kernels: None }))
    };
    #[cfg(not(target_arch = "wasm32"))]
    let task = async move {
        let (pipelines, mut made) = link()?;
        bevy::tasks::block_on(pipelines.compile(&mut |_, _| ()));
        made.link_probes()?;
        // The remaining kernels, for holes and textures: a frame that needs one earlier waits for
        // it.
        let rest = async move { bevy::tasks::block_on(pipelines.compile_all(&mut |_, _| ())) };
        beside_frames(rest).detach();
        Ok(made)
    };
    #[cfg(target_arch = "wasm32")]
    let task = async move {
        let (pipelines, mut made) = link()?;
        pipelines.compile(&mut |_, _| ()).await;
        made.link_probes()?;
        beside_frames(async move { pipelines.compile_all(&mut |_, _| ()).await }).detach();
        Ok(made)
    };
    beside_frames(task)
}

/// Spawns a background task. It must be `Send` for Bevy's pool of several threads, a Cargo feature;
/// this function requires it with any features.
#[cfg(not(target_arch = "wasm32"))]
pub(crate) fn beside_frames<T: Send + 'static>(
    task: impl Future<Output = T> + Send + 'static,
) -> Task<T> {
    AsyncComputeTaskPool::get().spawn(task)
}

/// Spawns a background task.
#[cfg(target_arch = "wasm32")]
pub(crate) fn beside_frames<T: 'static>(task: impl Future<Output = T> + 'static) -> Task<T> {
    AsyncComputeTaskPool::get().spawn(task)
}

impl Made {
    /// Links the probes' kernels. It runs after all others are compiled, since these are compiled
    /// only once something is drawn forward.
    fn link_probes(&mut self) -> Result<(), GiError> {
        if ARE_USABLE {
            self.probe_kernels = Some(ProbeKernels::new(&self.gi)?);
        }
        Ok(())
    }
}

impl Voxels {
    pub(crate) fn new(
        Made { gi, cube, compose, probe_kernels }: Made,
        number: u64,
        (ambient, maps): (Vec3, &ShadowMaps),
        fitted: Option<[Vec3; 2]>,
    ) -> Self {
        let lights = gi.bind_lights(&[], ambient, ShadowSource::Own(&maps.bound));
        Self {
            gi,
            lights,
            compose,
            number,
            lit_by: LitBy { lights: Vec::new(), ambient, has_map: false, shadow_maps: None },
            cube,
            taken: None,
            frames_taken: 0,
            version: None,
            is_late: false,
            frames_lit: 0,
            frames_at_rest: 0,
            fitted,
            probes: None,
            probe_kernels,
        }
    }

    /// Whether the surroundings are an environment map.
    pub(crate) fn holds_map(&self) -> bool {
        self.taken.is_some()
    }

    /// Copies the environment map if it has changed.
    fn follow_map(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) {
        let Some((cube, surroundings)) = frame.map else {
            self.taken = None;
            return;
        };
        let settings = surroundings.cube_use(frame.share, frame.ambient);
        let is_known = self.taken.as_ref().is_some_and(|taken| *taken == (cube.clone(), settings));
        self.frames_taken = self.frames_taken.saturating_add(1);
        let is_due = frame.is_map_redrawn || surroundings.is_due(self.frames_taken);
        if is_known && !is_due {
            return;
        }
        self.cube.record(&mut Recorder::on(device, queue, encoder), cube, settings);
        self.lights.invalidate();
        if !is_known || frame.is_map_redrawn {
            self.frames_at_rest = 0;
            self.frames_taken = 0;
            self.taken = Some((cube.clone(), settings));
        }
    }

    /// Sets the lights, if they have changed.
    fn follow_lights(&mut self, queue: &wgpu::Queue, frame: &Frame<'_>) {
        let bound = &frame.shadow_maps.bound;
        let is_known = self.lit_by.lights == frame.lights
            && self.lit_by.ambient == frame.ambient
            && self.lit_by.has_map == self.holds_map()
            && self.lit_by.shadow_maps.as_ref() == Some(bound);
        if is_known {
            return;
        }
        self.frames_at_rest = 0;
        self.lit_by.lights.clear();
        self.lit_by.lights.extend_from_slice(frame.lights);
        self.lit_by.ambient = frame.ambient;
        self.lit_by.has_map = self.holds_map();
        self.lit_by.shadow_maps = Some(bound.clone());
        let environment = match self.taken {
            // The map already includes the ambient light.
            Some(_) => EnvironmentLight {
                radiance: Vec3::ONE,
                map: Some(self.cube.map()),
                rotation_rad: 0.0,
            },
            None => EnvironmentLight::from(frame.ambient),
        };
        self.lights.update(queue, frame.lights, environment, ShadowSource::Own(bound));
    }

    /// Requires some lit frames before the voxels may be shown again.
    pub(crate) fn light_anew(&mut self) {
        self.frames_lit = 0;
    }

    /// Whether the voxels may be shown.
    pub(crate) fn is_lit(&self) -> bool {
        // Without lit probes, forward draws would be dark for a while.
        let are_probes_lit = self.probes.as_ref().is_none_or(Probes::are_lit);
        let is_lit = self.gi.voxels().is_some() && !self.is_late;
        is_lit && self.frames_lit >= FRAMES_TO_LIGHT && are_probes_lit
    }

    /// Applies changes of geometry and lights, and records the work of the frame.
    pub(crate) fn record(
        &mut self,
        (device, queue): (&wgpu::Device, &wgpu::Queue),
        encoder: &mut wgpu::CommandEncoder,
        frame: &Frame<'_>,
    ) -> Result<(), GiError> {
        let version = frame.scene.geometry.version();
        self.follow_map((device, queue), encoder, frame);
        self.follow_lights(queue, frame);
        if frame.has_mapped_lights() && FRAMES_OF_NEW_MAPS.contains(&self.frames_at_rest) {
            self.lights.invalidate();
        }
        self.frames_at_rest = self.frames_at_rest.saturating_add(1);
        let moves = frame.gi.volume.cascades().is_some() && self.gi.center_on(frame.position)?;
        if self.version != Some(version) || moves {
            self.version = Some(version);
            self.frames_at_rest = 0;
        }
        let span = frame.diagnostics.map(|to| to.time_span(encoder, "lumivox/light"));
        let mut recorder = Recorder::on(device, queue, encoder);
        let settings = frame.gi.trace_settings();
        let faces_per_frame = frame.gi.face_budget();
        let inputs = lumivox::Frame::new(&frame.scene.geometry, &self.lights, &settings);
        let lit = self.gi.frame(&mut recorder, lumivox::Frame { faces_per_frame, ..inputs });
        drop(recorder);
        if let Some(span) = span {
            span.end(encoder);
        }
        self.is_late = lit?.is_late;
        if self.gi.voxels().is_none() {
            return Ok(());
        }
        self.frames_lit = self.frames_lit.saturating_add(1);
        let Some(kernels) = &self.probe_kernels else { return Ok(()) };
        let of = (&self.gi, &self.lights);
        let mut recorder = Recorder::on(device, queue, encoder);
        Probes::record(&mut self.probes, kernels, of, &frame.gi, frame.has_forward, &mut recorder)
    }
}
