//! A scene rendered to a picture, pass by pass.

mod prepare;

use lumivox::gpu::{Recorder, StageTime, Timing};
use lumivox::{EnvironmentMap, Gi, Grid, Lights, VoxelizeStats};
use lumivox_scene::{Camera, Scene};

use crate::composite::CompositePass;
use crate::direct::DirectPass;
use crate::gbuffer_pass::{self, GBufferPass};
use crate::memory::MemoryUse;
use crate::readback::read_texture;
use crate::shadow_maps::ShadowMapPass;
use crate::targets::Targets;
use crate::times::Times;
use crate::tone_map::Encoding;
use crate::upload::{GpuScene, Lighting, corners, radiance_unit_within};
use crate::{
    COST_SCALE_SAMPLES, Exposure, Gpu, Picture, RenderError, RenderSettings, ShadowMethod, ToneMap,
    View,
};
pub use prepare::global_illumination;
use prepare::{bind_lights, environment_map, upload};

/// How far the work is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Progress {
    /// What is under way: `upload`, `voxelize`, `light` or `render`.
    pub stage: &'static str,
    /// Steps done, from 0 to `total`.
    pub done: u32,
    /// Steps of this stage.
    pub total: u32,
}

/// Renders one scene with one set of settings.
#[derive(Debug)]
pub struct Renderer {
    gpu: Gpu,
    settings: RenderSettings,
    camera: Camera,
    scene: GpuScene,
    gi: Gi,
    lights: Lights,
    voxels: VoxelizeStats,
    gbuffer: GBufferPass,
    shadow_pass: Option<ShadowMapPass>,
    direct: DirectPass,
    composite: CompositePass,
    targets: Targets,
    environment: Option<EnvironmentMap>,
    shadow_bytes: u64,
    times: Times,
}

impl Renderer {
    /// Prepares a scene: uploads it, fits the grid to its bounds, voxelizes it and lights the voxels.
    ///
    /// The camera is the one given, else the scene's first, else one that frames all of it. `progress`
    /// hears of the stages `upload`, `voxelize` and `light`.
    ///
    /// # Errors
    /// When a setting is out of range, when something does not fit the device or its memory, and when
    /// the device fails.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: Option<&Camera>,
        settings: RenderSettings,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Self, RenderError> {
        validate(&settings, gpu)?;
        let bounds = settings.grid_bounds.unwrap_or_else(|| scene.voxel_bounds());
        let camera = camera.or(scene.cameras.first()).cloned();
        let camera = camera.unwrap_or_else(|| {
            scene.default_camera(settings.size.x as f32 / settings.size.y as f32)
        });
        let grid = Grid::fit(bounds.min, bounds.max, settings.resolution, settings.grid_offset)?;
        validate_level(settings.voxel_level, &grid)?;
        let mut times = Times::default();

        progress(Progress { stage: "upload", done: 0, total: 1 });
        let lighting = Lighting::of(scene);
        let unit = radiance_unit_within(bounds, scene, &lighting);
        let mut scene = upload(gpu, scene, &lighting, unit, &settings).await?;
        // Shadow maps hold what lies outside of the grid, too.
        scene.bounds = bounds.union(scene.bounds);
        progress(Progress { stage: "upload", done: 1, total: 1 });

        progress(Progress { stage: "voxelize", done: 0, total: 1 });
        let config = settings.gi_config(grid);
        let mut gi = global_illumination(gpu, config).await?;
        let voxelized = gi.voxelize(&scene.geometry, settings.timing).await?;
        times.add(voxelized.times);
        gpu.check("voxelizing")?;
        progress(Progress { stage: "voxelize", done: 1, total: 1 });

        progress(Progress { stage: "light", done: 0, total: 1 });
        let shaders = crate::shaders::library(gi.shaders());
        let shadow_pass = match settings.shadows {
            ShadowMethod::Map => Some(ShadowMapPass::new(&gpu.device, &shaders, &scene)?),
            ShadowMethod::Cone => None,
        };
        let mut recorder = Recorder::with_timing(&gpu.device, &gpu.queue, settings.timing);
        let map = environment_map(gpu, &lighting)?;
        let (lights, shadow_bytes) = bind_lights(
            gpu,
            &mut recorder,
            shadow_pass.as_ref(),
            &scene,
            (&lighting, map.as_ref()),
            &gi,
            &settings,
        );
        if settings.timing != Timing::Off {
            // Drivers compile a kernel at its first use, which is no part of a stage's time.
            let mut first_use = Recorder::new(&gpu.device, &gpu.queue);
            gi.light(&mut first_use, &lights, settings.voxel_bounces().min(2), &settings.trace)?;
            first_use.submit();
            gi.forget_light();
        }
        recorder.stage("light");
        gi.light(&mut recorder, &lights, settings.voxel_bounces(), &settings.trace)?;
        times.add(recorder.finish().await?);
        gpu.wait("lighting the voxels")?;
        progress(Progress { stage: "light", done: 1, total: 1 });

        let gbuffer = GBufferPass::new(&gpu.device, &shaders, &scene)?;
        let direct = DirectPass::new(&gpu.device, &shaders, &gi)?;
        let composite = CompositePass::new(&gpu.device, &shaders, &gi)?;
        let passes = (&direct, &composite);
        let resolution = settings.trace.resolution;
        let is_tinted = scene.is_tinted();
        let targets =
            Targets::new(gpu, &shaders, &gi, passes, settings.size, resolution, is_tinted).await?;
        gpu.check("making the picture's textures")?;
        Ok(Self {
            gpu: gpu.clone(),
            settings,
            camera,
            scene,
            gi,
            lights,
            voxels: voxelized.stats,
            gbuffer,
            shadow_pass,
            direct,
            composite,
            targets,
            environment: map,
            shadow_bytes,
            times,
        })
    }

    /// Shows the same scene in another pose; the mean starts anew. The camera stays.
    ///
    /// Vertices and transforms are uploaded, voxelized and lit again; where instances are marked as static
    /// and are what they were, what was found of their triangles stays. All else stays: pipelines,
    /// textures, targets, the grid, the unit of radiance and the environment's map. So a scene that moves out of the grid
    /// loses what is outside; give [`RenderSettings::grid_bounds`] when the renderer is made.
    /// `progress` hears of the stages `upload`, `voxelize` and `light`.
    ///
    /// # Errors
    /// When it is another scene, of other materials; when nothing of it lies in the grid, something
    /// does not fit the device, or the device fails.
    pub async fn set_scene(
        &mut self,
        scene: &Scene,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<(), RenderError> {
        let Self { gpu, settings, gi, .. } = self;
        progress(Progress { stage: "upload", done: 0, total: 1 });
        let lighting = Lighting::of(scene);
        self.scene.repose(gpu, scene)?;
        self.gbuffer.set_scene(&gpu.device, &self.scene);
        if let Some(pass) = &mut self.shadow_pass {
            pass.set_scene(&gpu.device, &self.scene);
        }
        gpu.check("uploading the scene")?;
        progress(Progress { stage: "upload", done: 1, total: 1 });

        progress(Progress { stage: "voxelize", done: 0, total: 1 });
        let voxelized = gi.voxelize_dynamic(&self.scene.geometry, settings.timing).await?;
        self.voxels = voxelized.stats;
        self.times.add(voxelized.times);
        gpu.check("voxelizing")?;
        progress(Progress { stage: "voxelize", done: 1, total: 1 });

        progress(Progress { stage: "light", done: 0, total: 1 });
        let mut recorder = Recorder::with_timing(&gpu.device, &gpu.queue, settings.timing);
        (self.lights, self.shadow_bytes) = bind_lights(
            gpu,
            &mut recorder,
            self.shadow_pass.as_ref(),
            &self.scene,
            (&lighting, self.environment.as_ref()),
            gi,
            settings,
        );
        recorder.stage("light");
        gi.light(&mut recorder, &self.lights, settings.voxel_bounces(), &settings.trace)?;
        self.times.add(recorder.finish().await?);
        gpu.wait("lighting the voxels")?;
        progress(Progress { stage: "light", done: 1, total: 1 });
        self.targets.accumulate.reset();
        Ok(())
    }

    /// Renders all frames that the settings ask for and are not there yet, and finishes the picture.
    /// `progress` hears of the stage `render`, frame by frame.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render(
        &mut self,
        progress: &mut dyn FnMut(Progress),
    ) -> Result<Picture, RenderError> {
        let total = self.settings.frames;
        progress(Progress { stage: "render", done: self.frame_count().min(total), total });
        while self.frame_count() < total {
            self.render_frame().await?;
            // One frame in flight: progress is then the truth, and memory for commands stays small.
            self.gpu.wait("rendering a frame")?;
            progress(Progress { stage: "render", done: self.frame_count(), total });
        }
        self.finish().await
    }

    /// Renders one frame more into the mean.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render_frame(&mut self) -> Result<(), RenderError> {
        let frame = self.frame_count();
        let Self { settings, camera, scene, gi, lights, targets, .. } = self;
        let jitter = gbuffer_pass::jitter(frame, settings.frames);
        let clip_from_world = gbuffer_pass::clip_from_world(camera, settings.size, jitter);
        let (position, size) = (camera.position, settings.size);
        let view = lumivox::View { clip_from_world, position, size, frame };
        targets.gbuffer.set_view(&self.gpu.queue, view);

        let mut recorder =
            Recorder::with_timing(&self.gpu.device, &self.gpu.queue, settings.timing);
        if settings.view.is_of_voxels() {
            recorder.stage("voxel view");
            targets.voxel_view.record(
                &mut recorder,
                gi,
                lights,
                &targets.gbuffer,
                (settings.view, settings.voxel_level),
                camera.vertical_fov_rad,
            );
        } else {
            recorder.stage("G-buffer");
            let textures = &targets.gbuffer_textures;
            self.gbuffer.record(&mut recorder, scene, textures, &view);
            if settings.view.needs_direct() {
                recorder.stage("direct light");
                self.direct.record(&mut recorder, gi, lights, &targets.gbuffer, &targets.direct);
            }
            if settings.view.needs_cones(settings.bounces) {
                recorder.stage("trace");
                let (gbuffer, traced) = (&targets.gbuffer, &targets.traced);
                gi.trace(&mut recorder, gbuffer, lights, &settings.trace, traced)?;
            }
            recorder.stage("picture");
            let (gbuffer, composite) = (&targets.gbuffer, &targets.composite);
            self.composite.record(&mut recorder, lights, gbuffer, composite, settings.view);
        }
        recorder.stage("picture");
        targets.accumulate.record(&mut recorder);
        self.times.add(recorder.finish().await?);
        self.gpu.check("rendering a frame")
    }

    /// Frames in the picture so far.
    pub fn frame_count(&self) -> u32 {
        self.targets.accumulate.frames()
    }

    /// The picture of the frames so far; at least one is needed for it to show something.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn finish(&mut self) -> Result<Picture, RenderError> {
        let mean = self.targets.accumulate.mean();
        let mut hdr: Vec<[f32; 4]> = read_texture(&self.gpu, mean).await?;
        if self.settings.view.is_light() {
            let unit = self.scene.radiance_unit;
            for pixel in &mut hdr {
                *pixel = [pixel[0] * unit, pixel[1] * unit, pixel[2] * unit, pixel[3]];
            }
        }
        let encoding = self.encoding(&hdr);
        let mut recorder =
            Recorder::with_timing(&self.gpu.device, &self.gpu.queue, self.settings.timing);
        recorder.stage("picture");
        self.targets.tone_map.record(&mut recorder, mean, encoding);
        self.times.add(recorder.finish().await?);
        let ldr = read_texture(&self.gpu, self.targets.tone_map.screen()).await?;
        self.gpu.check("reading the picture back")?;
        Ok(Picture { size: self.settings.size, hdr, ldr })
    }

    /// How the current view is brought to the screen; `hdr` is in real units, the GPU's texture in
    /// multiples of the unit of radiance.
    fn encoding(&self, hdr: &[[f32; 4]]) -> Encoding {
        match self.settings.view {
            View::Occlusion | View::Shadow => Encoding::Data { scale: 1.0, offset: 0.0 },
            View::Normal => Encoding::Data { scale: 0.5, offset: 0.5 },
            View::Albedo | View::Lit | View::Nodes => {
                Encoding::Color { scale: 1.0, curve: ToneMap::Linear }
            }
            View::Cost => Encoding::Heat { scale: 1.0 / COST_SCALE_SAMPLES },
            View::Depth => {
                let farthest_m = corners(self.scene.bounds)
                    .map(|corner| corner.distance(self.camera.position))
                    .into_iter()
                    .fold(f32::MIN_POSITIVE, f32::max);
                Encoding::Data { scale: -1.0 / farthest_m, offset: 1.0 }
            }
            _ => {
                let stops = self.settings.exposure.stops(hdr);
                let scale = stops.exp2() * self.scene.radiance_unit;
                Encoding::Color { scale, curve: self.settings.tone_map }
            }
        }
    }

    /// Lights the voxels again with another number of bounces; the mean starts anew.
    ///
    /// # Errors
    /// [`RenderError::Setting`] when there are too many, and when the device fails.
    pub async fn set_bounces(&mut self, bounces: u32) -> Result<(), RenderError> {
        let settings = RenderSettings { bounces, ..self.settings.clone() };
        settings.validate(&self.gpu.device.limits())?;
        self.settings = settings;
        let mut recorder =
            Recorder::with_timing(&self.gpu.device, &self.gpu.queue, self.settings.timing);
        recorder.stage("light");
        let bounces = self.settings.voxel_bounces();
        self.gi.light(&mut recorder, &self.lights, bounces, &self.settings.trace)?;
        self.times.add(recorder.finish().await?);
        self.gpu.wait("lighting the voxels")?;
        self.targets.accumulate.reset();
        Ok(())
    }

    /// Moves the camera; the mean starts anew.
    pub fn set_camera(&mut self, camera: Camera) {
        self.camera = camera;
        self.targets.accumulate.reset();
    }

    /// Changes how pictures are exposed from now on; the frames so far stay.
    pub fn set_exposure(&mut self, exposure: Exposure) {
        self.settings.exposure = exposure;
    }

    /// Changes what is shown; the mean starts anew. The level is that of the views of voxels.
    ///
    /// # Errors
    /// [`RenderError::Setting`] when there is no such level, or when the volume does not have what is to be
    /// shown.
    pub fn set_view(&mut self, view: View, voxel_level: u32) -> Result<(), RenderError> {
        validate_level(voxel_level, self.gi.grid())?;
        let settings = RenderSettings { view, voxel_level, ..self.settings.clone() };
        settings.validate(&self.gpu.device.limits())?;
        let was = std::mem::replace(&mut self.settings, settings);
        let bounces = self.settings.voxel_bounces();
        if bounces != was.voxel_bounces() {
            let mut recorder = Recorder::new(&self.gpu.device, &self.gpu.queue);
            self.gi.light(&mut recorder, &self.lights, bounces, &self.settings.trace)?;
            recorder.submit();
        }
        self.targets.accumulate.reset();
        Ok(())
    }

    /// The camera in use.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The settings in use.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The global illumination, for its grid and voxels.
    pub fn gi(&self) -> &Gi {
        &self.gi
    }

    /// What the voxelization found.
    pub fn voxel_stats(&self) -> &VoxelizeStats {
        &self.voxels
    }

    /// The times of all passes so far, in order: the mean over the frames that had them. Empty
    /// unless the settings ask for times.
    pub fn times(&self) -> Vec<StageTime> {
        self.times.means()
    }

    /// Forgets the times so far: what comes runs with kernels that the driver has compiled.
    pub fn forget_times(&mut self) {
        self.times = Times::default();
    }

    /// Lets the next lighting store and filter all voxels, even those whose light is what the volume holds already:
    /// for measurements.
    pub fn forget_light(&mut self) {
        self.gi.forget_light();
    }

    /// GPU memory by what it holds.
    pub fn memory(&self) -> Vec<MemoryUse> {
        let mut memory = self.scene.memory.clone();
        memory.push(MemoryUse::new("shadow maps", self.shadow_bytes));
        let environment_bytes = self.environment.as_ref().map_or(0, EnvironmentMap::memory);
        memory.push(MemoryUse::new("environment", environment_bytes));
        let gi = self.gi.memory();
        memory.extend(gi.into_iter().map(|(name, bytes)| MemoryUse::new(name, bytes)));
        memory.push(MemoryUse::new("picture", self.targets.bytes));
        memory
    }
}

fn validate(settings: &RenderSettings, gpu: &Gpu) -> Result<(), RenderError> {
    settings.validate(&gpu.device.limits())?;
    let has_timestamps = gpu.device.features().contains(wgpu::Features::TIMESTAMP_QUERY);
    if settings.timing == Timing::Timestamps && !has_timestamps {
        return Err(RenderError::Setting {
            name: "timing",
            value: "by timestamps".to_owned(),
            expected: "off or by waiting: this device has no timestamps".to_owned(),
        });
    }
    Ok(())
}

fn validate_level(level: u32, grid: &Grid) -> Result<(), RenderError> {
    if level < grid.levels {
        return Ok(());
    }
    Err(RenderError::Setting {
        name: "voxel level",
        value: level.to_string(),
        expected: format!("from 0 to {}", grid.levels - 1),
    })
}
