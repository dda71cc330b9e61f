//! A scene rendered to a picture, pass by pass.

pub(crate) mod beside;
mod change;
pub(crate) mod estimate;
mod faces;
mod figures;
mod overlay;
mod passes;
mod photometry;
mod prepare;
mod samples;
mod screen;
mod updates;

use std::ops::ControlFlow;

use lumivox::gpu::{Recorder, StageTime, Timing};
use lumivox::{EnvironmentMap, FrameStatus, Gi, Grid, Lights, VolumeKind, VoxelizeStats};
use lumivox_scene::{Bounds, Camera, Scene};

use crate::gpu::memory::MemoryUse;
use crate::gpu::times::StageTimes;
use crate::look::{LookFrame, LookParts, LookPasses, LookScene};
use crate::passes::accumulate::weight_of_sample;
use crate::passes::composite::Composed;
use crate::passes::near_shadows::NearShadows;
use crate::passes::targets::Targets;
use crate::scene::{GpuScene, Lighting, radiance_unit_within};
use crate::{Gpu, Picture, RenderError, RenderSettings, View};
pub use faces::VoxelFace;
pub use figures::TraceFigures;
use passes::Passes;
pub use photometry::Photometry;
pub use prepare::global_illumination;
use prepare::{compile, environment_map, upload, validate, validate_level, voxelize};
use samples::camera_view;
use updates::Updates;

/// The progress of rendering.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RenderProgress {
    /// The current stage: `upload`, `compile`, `voxelize`, `light` or `render`.
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
    /// The box that the grid is fitted to if the settings have none.
    scene_bounds: Bounds,
    /// `true` if the scene defines its own grid, which may be empty.
    may_be_empty: bool,
    /// The box that the grid is fitted to.
    grid_bounds: Bounds,
    /// The box around everything visible; shadow maps include the parts outside the grid.
    shown_bounds: Bounds,
    lighting: Lighting,
    gi: Gi,
    lights: Lights,
    /// Shadow maps around the camera, for the direct light of pixels.
    near_shadows: NearShadows,
    /// The grid for which the shadow maps were drawn.
    mapped_grid: Grid,
    voxels: VoxelizeStats,
    voxels_are_stale: bool,
    updates: Updates,
    passes: Passes,
    targets: Targets,
    /// The parts of the scene for looks.
    look_scene: LookScene,
    /// The passes of the settings' look; `None` before it first draws.
    look: Option<Box<dyn LookPasses>>,
    environment: Option<EnvironmentMap>,
    shadow_bytes: u64,
    times: StageTimes,
    /// Samples per pixel drawn so far, over all pictures.
    samples_drawn: u32,
    /// The number of consecutive frames that each started a new mean.
    restarts: u32,
}

impl Renderer {
    /// Prepares a scene: uploads it, fits the grid to its bounds, voxelizes it and lights the
    /// voxels.
    ///
    /// The camera is `camera`, or the scene's first, or one that frames the whole scene. `progress`
    /// is called with the stages `upload`, `compile` (if some pipelines are missing), `voxelize`
    /// and `light`.
    ///
    /// # Errors
    /// When a setting is out of range, when no part of the scene is in the grid (unless it has a
    /// grid of its own, [`Scene::grid_bounds`]), when something does not fit the device or its
    /// memory, and when the device fails.
    pub async fn new(
        gpu: &Gpu,
        scene: &Scene,
        camera: Option<&Camera>,
        settings: RenderSettings,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Self, RenderError> {
        // Boxed, since its state is too large for the callers' futures.
        let mut renderer = Box::pin(Self::unlit(gpu, scene, camera, settings, progress)).await?;
        if renderer.settings.timing != Timing::Off {
            renderer.use_kernels_of_light()?;
        }
        renderer.relight(progress).await?;
        Ok(renderer)
    }

    /// Everything of [`Self::new`] except light.
    async fn unlit(
        gpu: &Gpu,
        scene: &Scene,
        camera: Option<&Camera>,
        settings: RenderSettings,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Self, RenderError> {
        validate(&settings, gpu)?;
        let scene_bounds = scene.voxel_bounds();
        let may_be_empty = scene.grid_bounds.is_some() || settings.volume == VolumeKind::Cascades;
        let bounds = settings.grid_bounds.unwrap_or(scene_bounds);
        let camera = camera.or(scene.cameras.first()).cloned();
        let camera = camera.unwrap_or_else(|| {
            scene.default_camera(settings.size.x as f32 / settings.size.y as f32)
        });
        let grid = settings.grid(bounds, camera.position)?;
        validate_level(&settings, &grid)?;
        let mut times = StageTimes::default();

        progress(RenderProgress { stage: "upload", done: 0, total: 1 });
        let lighting = Lighting::of(scene);
        let unit = radiance_unit_within(bounds, scene, &lighting);
        let look_scene = LookScene::of(scene);
        let given = scene;
        let mut scene = upload(gpu, scene, &lighting, unit, &settings, camera.position).await?;
        let shown_bounds = scene.bounds;
        scene.bounds = bounds.union(shown_bounds);
        progress(RenderProgress { stage: "upload", done: 1, total: 1 });

        let mut gi = global_illumination(gpu, settings.gi_config(grid)).await?;
        let passes = Passes::new(gpu, &gi, &scene, &settings)?;
        let targets = passes.targets(gpu, &gi, &scene, &settings).await?;
        gpu.check("making the picture's textures")?;
        let mut look = None;
        if let Some(shown) = settings.shown_look() {
            let resolution = settings.resolution;
            let parts =
                LookParts { gpu, shaders: &passes.shaders, gi: &gi, scene: &scene, resolution };
            look.insert(shown.passes(&look_scene, bounds)).prepare(&parts)?;
        }
        compile(gpu, (&gi, &scene.geometry), &settings, progress).await?;

        progress(RenderProgress { stage: "voxelize", done: 0, total: 1 });
        let voxelized = voxelize(&mut gi, &scene.geometry, settings.timing, may_be_empty).await;
        let voxelized = voxelized.map_err(|error| RenderError::of_scene(error, given))?;
        if voxelized.stats.voxels == 0 && settings.volume == VolumeKind::Cascades {
            tracing::warn!(
                "no surface is within {} m of the camera, as far as the cascades reach: nothing has light from voxels; more \
                 cascades reach farther (--cascades)",
                0.5 * settings.cascades.reach_m()
            );
        }
        times.add(voxelized.times);
        gpu.check("voxelizing")?;
        progress(RenderProgress { stage: "voxelize", done: 1, total: 1 });

        let map = environment_map(gpu, &lighting)?;
        // `relight` will bind the scene's lights.
        let lights = gi.bind_lights(&[], glam::Vec3::ZERO, None);
        let near_shadows = NearShadows::new(gpu, &lights);
        Ok(Self {
            gpu: gpu.clone(),
            settings,
            camera,
            scene,
            scene_bounds,
            may_be_empty,
            grid_bounds: bounds,
            shown_bounds,
            lighting,
            gi,
            lights,
            near_shadows,
            mapped_grid: grid,
            voxels: voxelized.stats,
            voxels_are_stale: false,
            updates: Updates::default(),
            passes,
            targets,
            look_scene,
            look,
            environment: map,
            shadow_bytes: 0,
            times,
            samples_drawn: 0,
            restarts: 0,
        })
    }

    /// Runs the kernels of light once: drivers compile a kernel at its first use, and stages' times
    /// must not include that.
    fn use_kernels_of_light(&mut self) -> Result<(), RenderError> {
        let Self { gpu, gi, lights, settings, .. } = self;
        if settings.shown_look().is_none() {
            let mut recorder = Recorder::new(&gpu.device, &gpu.queue);
            gi.light(&mut recorder, lights, settings.voxel_bounces().min(2), &settings.trace)?;
            recorder.submit();
            gi.forget_light();
        }
        Ok(())
    }

    /// Renders the frames still missing from the settings' number, and finishes the picture.
    /// `progress` is called with the stage `render` after each frame.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress),
    ) -> Result<Picture, RenderError> {
        let mut go_on = |step| {
            progress(step);
            ControlFlow::Continue(())
        };
        self.render_frames(&mut go_on).await?;
        self.complete_overlay().await?;
        self.finish().await
    }

    /// Like [`Self::render`], until `progress` breaks between two frames: it then returns no
    /// picture, and the frames so far are kept.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render_until(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress) -> ControlFlow<()>,
    ) -> Result<Option<Picture>, RenderError> {
        self.render_frames(progress).await?;
        if !self.is_complete() {
            return Ok(None);
        }
        self.complete_overlay().await?;
        self.finish().await.map(Some)
    }

    async fn render_frames(
        &mut self,
        progress: &mut dyn FnMut(RenderProgress) -> ControlFlow<()>,
    ) -> Result<(), RenderError> {
        let total = self.settings.frames;
        let step = |done: u32| RenderProgress { stage: "render", done: done.min(total), total };
        let mut wish = progress(step(self.frame_count()));
        while !self.is_complete() && wish.is_continue() {
            self.render_frame().await?;
            // Only one frame is in flight, so that the progress is accurate and commands use little
            // memory.
            self.gpu.wait("rendering a frame")?;
            wish = progress(step(self.frame_count()));
        }
        Ok(())
    }

    /// Renders one more frame into the mean.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn render_frame(&mut self) -> Result<(), RenderError> {
        self.draw_frame(true).await.map(|_| ())
    }

    /// Renders the next frame only to time it: the mean is unchanged.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn rehearse_frame(&mut self) -> Result<(), RenderError> {
        self.draw_frame(false).await.map(|_| ())
    }

    /// Renders a frame, and adds it to the mean if `is_kept`.
    async fn draw_frame(&mut self, is_kept: bool) -> Result<FrameStatus, RenderError> {
        self.move_with_camera().await?;
        self.prepare_view().await?;
        let mut recorder = self.recorder();
        self.record_updates(&mut recorder)?;
        let samples = if is_kept { self.take_samples() } else { 1 };
        self.record_frame(&mut recorder, is_kept, samples)?;
        let mut times = recorder.finish().await?;
        times.extend(self.draw_further_samples(samples).await?);
        self.times.add(times);
        self.gpu.check("rendering a frame")?;
        Ok(self.gi.status())
    }

    /// Records the passes of the first of the next frame's `samples` samples, and adds it to the
    /// mean if `is_kept`.
    fn record_frame(
        &mut self,
        recorder: &mut Recorder<'_>,
        is_kept: bool,
        samples: u32,
    ) -> Result<(), RenderError> {
        let frame = self.frame_count();
        let sample = self.first_sample(frame);
        let jitter = self.first_in_pixel(sample);
        let is_relit = self.updates.is_settling;
        let Self { settings, camera, scene, gi, lights, near_shadows, passes, targets, .. } = self;
        let shows_surfaces = settings.shown_look().is_none()
            && !settings.view.is_of_voxels()
            && settings.view != View::Lod;
        let has_cones = shows_surfaces && settings.view.needs_cones(settings.bounces);
        // Frames that are blended over time are numbered across pictures, so that their cones
        // differ.
        let number = (!(has_cones && targets.view.is_temporal())).then_some(frame);
        let seen = camera_view(camera, settings.size, (number, jitter));
        targets.view.set_camera(&self.gpu.queue, seen);
        targets.view.settings = settings.trace;

        if settings.shown_look().is_some() {
            self.record_look(recorder);
        } else if settings.view.is_of_voxels() {
            recorder.stage("voxel view");
            targets.voxel_view.record(
                recorder,
                gi,
                lights,
                &targets.view,
                (settings.view, settings.voxel_level),
                camera.vertical_fov_rad,
            )?;
        } else {
            recorder.stage("G-buffer");
            let textures = &targets.gbuffer_textures;
            passes.gbuffer.record(recorder, scene, textures, (&targets.view, sample));
            if let Some(motion) = &textures.motion {
                let textures = [motion, &textures.depth];
                passes.motion.record(recorder, scene, textures, &targets.view);
            }
            if settings.view == View::Lod {
                recorder.stage("picture");
                let (what, fov) = ((settings.view, settings.voxel_level), camera.vertical_fov_rad);
                targets.voxel_view.record(recorder, gi, lights, &targets.view, what, fov)?;
            } else {
                if settings.view.needs_direct() {
                    if let Some(pass) = &passes.shadows {
                        near_shadows.record(&self.gpu, recorder, pass, scene, camera.position);
                    }
                    recorder.stage("direct light");
                    let lit_by = (&*lights, &*near_shadows);
                    let device = &self.gpu.device;
                    let Targets { view, direct, .. } = targets;
                    passes.direct.record(device, recorder, gi, lit_by, view, direct);
                }
                if has_cones {
                    recorder.stage("trace");
                    gi.trace(recorder, &mut targets.view, lights)?;
                }
                recorder.stage("picture");
                let composite = &targets.composite;
                let lit = (&*gi, &*lights, &targets.view);
                let weight = weight_of_sample(1.0 / (frame as f32 + 1.0), 0, samples);
                let composed = Composed { view: settings.view, has_cones, weight, to_traced: None };
                passes.composite.record(recorder, lit, composite, composed);
                for beside in targets.beside.iter_mut().filter(|_| is_kept) {
                    let counted = (composed, is_relit, (frame, samples));
                    beside.record(recorder, &passes.composite, lit, counted);
                }
            }
        }
        if is_kept {
            recorder.stage("picture");
            let shown = (self.settings.view, frame, samples);
            let Targets { accumulate, view, .. } = &mut self.targets;
            beside::add_frame(accumulate, recorder, shown, (view, is_relit));
            self.record_overlay(recorder, frame)?;
        }
        // The next frame cannot reuse the light of a frame that was not kept.
        if !(is_kept && has_cones) {
            self.targets.view.skip();
        }
        if !is_kept && frame == 0 {
            self.targets.forget();
        }
        self.scene.motion.settle(self.targets.gbuffer_textures.motion.is_some());
        self.samples_drawn = self.samples_drawn.wrapping_add(samples);
        Ok(())
    }

    /// Renders a picture with the look, including the depths and normals of its surfaces.
    fn record_look(&mut self, recorder: &mut Recorder) {
        let Self { gpu, settings, scene, lights, targets, look: Some(passes), .. } = self else {
            return;
        };
        let Some(look) = settings.shown_look() else { return };
        let frame = LookFrame {
            look,
            scene,
            lights,
            camera: &targets.view,
            shown: settings.view,
            level: settings.voxel_level,
            picture: &targets.composite.picture,
            depth: &targets.gbuffer_textures.depth,
            normals: &targets.gbuffer_textures.normals,
        };
        passes.record(gpu, recorder, &frame);
    }

    /// Compiles the pipelines that the view and the look need, unless an earlier frame did.
    async fn prepare_view(&mut self) -> Result<(), RenderError> {
        let Self {
            gpu, settings, scene, gi, passes, targets, look, look_scene, grid_bounds, ..
        } = self;
        if let Some(shown) = settings.shown_look() {
            let resolution = settings.resolution;
            let parts = LookParts { gpu, shaders: &passes.shaders, gi, scene, resolution };
            look.get_or_insert_with(|| shown.passes(look_scene, *grid_bounds)).prepare(&parts)?;
        } else if settings.view.is_of_voxels() || settings.view == View::Lod {
            targets.voxel_view.prepare(gi, settings.view)?;
        }
        self.prepare_beside()?;
        let Self { gpu, gi, scene, settings, .. } = self;
        compile(gpu, (gi, &scene.geometry), settings, &mut |_| {}).await
    }

    /// Frames in the picture so far.
    pub fn frame_count(&self) -> u32 {
        self.targets.accumulate.frames()
    }

    /// Whether the picture has all frames of the settings, and nothing is pending: no voxels of
    /// moved objects, and no upload of geometry.
    pub fn is_complete(&self) -> bool {
        self.frame_count() >= self.settings.frames
            && !self.are_voxels_late()
            && !self.scene.is_streaming()
    }

    /// Moves the camera; the mean starts again.
    pub fn set_camera(&mut self, camera: Camera) {
        self.camera = camera;
        self.targets.accumulate.reset();
    }

    /// The camera in use.
    pub fn camera(&self) -> &Camera {
        &self.camera
    }

    /// The settings in use.
    pub fn settings(&self) -> &RenderSettings {
        &self.settings
    }

    /// The global illumination, with its grid and voxels.
    pub fn gi(&self) -> &Gi {
        &self.gi
    }

    /// The statistics of the voxelization.
    pub fn voxel_stats(&self) -> &VoxelizeStats {
        &self.voxels
    }

    /// The mean time of each pass over the frames that ran it, in order of passes. Empty unless the
    /// settings enable timing.
    pub fn times(&self) -> Vec<StageTime> {
        self.times.means()
    }

    /// Discards the times so far, so that later ones exclude the driver's compilation of kernels.
    pub fn forget_times(&mut self) {
        self.times = StageTimes::default();
    }

    /// Makes the next lighting store and filter all voxels, even unchanged ones. For measurements.
    pub fn forget_light(&mut self) {
        self.gi.forget_light();
    }

    /// GPU memory by its use.
    pub fn memory(&self) -> Vec<MemoryUse> {
        let mut memory = self.scene.memory.clone();
        memory.push(MemoryUse::new("shadow maps", self.shadow_bytes));
        let environment_bytes = self.environment.as_ref().map_or(0, EnvironmentMap::memory);
        memory.push(MemoryUse::new("environment", environment_bytes));
        let gi = self.gi.memory();
        memory.extend(gi.into_iter().map(|(name, bytes)| MemoryUse::new(name, bytes)));
        memory.extend(self.look.iter().flat_map(|look| look.memory()));
        memory.push(MemoryUse::new("picture", self.targets.bytes));
        memory
    }
}
