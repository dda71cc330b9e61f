//! [`Gi`], the library's main type. The calls in `gi/frame.rs` never wait for the GPU.

mod config;
mod frame;
mod parts;
mod place;
mod points;
mod screen;

use std::sync::OnceLock;

use crate::cones::TraceSettings;
use crate::emitters::Emitters;
use crate::environment::{EnvironmentLight, EnvironmentMap};
use crate::gpu::{Buffer, Pipelines, Recorder, ShaderLibrary, StageTime, Timing};
use crate::light::{Budget, Light, Lighting, Lights, ShadowSource, lights_layout};
use crate::points::PointGatherer;
use crate::trace::{Tracer, gbuffer_layout};
use crate::volume::Volume;
use crate::volume::changes::Changes;
use crate::voxelize::{VoxelizeStats, VoxelizedScene, Voxelizer, known};
use crate::{Geometry, GiError};
pub use config::GiConfig;
pub use frame::{Frame, FrameStatus};
use place::refuse_with_cascades;

/// Results of a voxelization.
#[derive(Clone, Debug)]
pub struct Voxelized {
    /// Counts of triangles, voxels and faces.
    pub stats: VoxelizeStats,
    /// Time of each pass; empty with `Timing::Off`.
    pub times: Vec<StageTime>,
}

/// Voxel cone tracing on the caller's device.
///
/// An engine calls [`Self::frame`] and [`Self::trace`] in every frame. A still image takes
/// [`Self::voxelize`], which waits for the same voxels, [`Self::light`], with any number of
/// bounces, and [`Self::trace`].
///
/// ```
/// # pollster::block_on(async {
/// # let (device, queue) = lumivox::gpu::open_device().await?;
/// use glam::Vec3;
/// use lumivox::gpu::{Recorder, Timing, upload};
/// use lumivox::{
///     Draw, GatherSettings, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial,
///     TraceSettings,
/// };
///
/// // A triangle that reflects half of the light, and emits none, as it lies in an engine's
/// // buffers.
/// let corners = [[0.0_f32, 0.0, 0.0], [0.0, 0.0, 1.0], [1.0, 0.0, 0.0]];
/// let positions = upload(&device, "positions", &corners);
/// let indices = upload(&device, "indices", &[0_u32, 1, 2]);
/// let draws = vec![Draw::new(0, 3, 0)];
/// let batch = GeometryBatch::new((*positions).clone(), (*indices).clone(), draws);
/// let materials = vec![SurfaceMaterial::default()];
/// let geometry = Geometry::new(vec![batch], materials);
///
/// let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
/// let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
/// let voxelized = gi.voxelize(&geometry, Timing::Off).await?;
/// assert!(voxelized.stats.voxels > 0);
///
/// // Under a sky of radiance 1, with one bounce in the voxels.
/// let lights = gi.bind_lights(&[], Vec3::ONE, None);
/// let mut recorder = Recorder::new(&device, &queue);
/// gi.light(&mut recorder, &lights, 2, &TraceSettings::default())?;
/// recorder.submit();
///
/// // The reading of a lux meter above it that looks down: less than the sky's pi.
/// let settings = GatherSettings::default();
/// let above = Vec3::new(0.3, 0.2, 0.3);
/// let down = gi.gather(&[above], &[Vec3::NEG_Y], &lights, &settings).await?;
/// assert!(down[0].total().y < std::f32::consts::PI);
/// # Ok::<(), lumivox::GiError>(())
/// # }).unwrap();
/// ```
#[derive(Debug)]
pub struct Gi {
    /// Pipeline cache; derefs to the device.
    device: Pipelines,
    queue: wgpu::Queue,
    config: GiConfig,
    shaders: ShaderLibrary,
    /// Large parts are boxed: futures move objects of this type.
    voxelizer: Box<Voxelizer>,
    scene: Box<VoxelizedScene>,
    volume: Volume,
    /// `None` without cells.
    changes: Option<Changes>,
    lighting: Box<Lighting>,
    emitters: Box<Emitters>,
    tracer: Tracer,
    lights_layout: wgpu::BindGroupLayout,
    gbuffer_layout: wgpu::BindGroupLayout,
    /// Fallback for environments without a map.
    white: EnvironmentMap,
    /// Gathers of the last call of `light`, including the one on screen.
    bounces: u32,
    /// Changes whenever the volume's content changes.
    content: u64,
    /// The version of the last geometry, whether it was voxelized or refused.
    geometry: Option<u64>,
    /// `true` if that geometry was refused.
    is_refused: bool,
    /// Values of the cone model; unused without one.
    cone_values: [f32; 4],
    /// Created on first use.
    points: OnceLock<PointGatherer>,
}

impl Gi {
    /// Allocates the volume and links all kernels; each kernel is compiled on first use. Several
    /// `Gi`s created by this function on one device share no pipelines; use
    /// [`Self::with_pipelines`] to share them.
    ///
    /// # Errors
    /// As [`Self::with_pipelines`].
    pub fn new(
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        config: GiConfig,
    ) -> Result<Self, GiError> {
        Self::with_pipelines(&Pipelines::new(device), queue, config)
    }

    /// Like [`Self::new`], but uses the pipelines that already exist on a device.
    /// [`Pipelines::compile`] compiles all missing ones at once.
    ///
    /// # Errors
    /// [`GiError::Limit`] if the device cannot hold the volume: the error names the limit and what
    /// would fit; [`GiError::Budget`] if dense cells exceed the memory budget; [`GiError::Shader`]
    /// if a kernel does not link, which is a bug in this crate.
    pub fn with_pipelines(
        device: &Pipelines,
        queue: &wgpu::Queue,
        config: GiConfig,
    ) -> Result<Self, GiError> {
        check_limits(&device.limits())?;
        let mut shaders = crate::shaders::library();
        if let Some(model) = &config.cones {
            shaders.add("cones::model", model.module());
        }
        if let Some(own) = &config.gbuffer {
            let mut source = own.source.to_string();
            if !source.contains("fn load_albedo") {
                source += "\nfn load_albedo(pixel: vec2u) -> vec4f { return vec4f(0.0); }\n";
            }
            shaders.add("trace::gbuffer", source);
        }
        if let Some(own) = &config.shadow_maps {
            shaders.add("light::shadow_map", own.source.clone());
        }
        shaders.constant_u32("HAS_INJECTION", u32::from(config.injection.is_some()));
        if config.grid.cascades.is_some() {
            refuse_with_cascades("voxelizer", config.voxelizer.is_some())?;
            refuse_with_cascades("injection", config.injection.is_some())?;
        }
        let cone_values = config.cones.as_ref().map_or([0.0; 4], |model| model.values());
        crate::cones::mount(&mut shaders, config.cones.is_some());
        let mut volume = Volume::new(
            device,
            &mut shaders,
            &config.grid,
            (config.volume, config.directionality),
            config.octree_builder.as_deref(),
            (config.memory_budget, config.cones.is_some(), config.has_cells()),
            &crate::emitters::empty_list(device),
        )?;
        let voxelizer = Voxelizer::new(device, &shaders, config.voxelizer.as_deref())?;
        let emitters = Emitters::new(device, queue, &shaders, &voxelizer, &config.grid)?;
        volume.bind_emitters(device, emitters.list());
        let scene = voxelizer.scene(device, queue, &config.grid);
        let changes = config
            .has_cells()
            .then(|| Changes::new(device, &shaders, &config.grid, scene.changed()))
            .transpose()?;
        let lights_layout = lights_layout(device, config.shadow_maps.as_ref());
        let gbuffer_layout = gbuffer_layout(device, config.gbuffer.as_ref());
        let globals = volume.globals_layout();
        let lighting = Lighting::new(
            device,
            &shaders,
            &config.grid,
            (config.injection.as_deref(), config.cones.is_some(), config.has_cells()),
            globals,
            &lights_layout,
        )?;
        let tracer = Tracer::new(device, &shaders, globals, &lights_layout, &gbuffer_layout)?;
        Ok(Self {
            device: device.clone(),
            queue: queue.clone(),
            config,
            shaders,
            voxelizer: Box::new(voxelizer),
            scene: Box::new(scene),
            volume,
            changes,
            lighting: Box::new(lighting),
            emitters: Box::new(emitters),
            tracer,
            lights_layout,
            gbuffer_layout,
            white: EnvironmentMap::white(device, queue),
            bounces: 0,
            content: 0,
            geometry: None,
            is_refused: false,
            cone_values,
            points: OnceLock::new(),
        })
    }

    /// Turns triangles into the list of voxels on which all light is computed.
    ///
    /// Buffers are sized from counts that are read back, so none overflows. The future waits for
    /// the GPU, without blocking in browsers. The voxels have no light until [`Self::light`].
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::gpu::{Timing, upload};
    /// # use lumivox::{
    /// #     Draw, Geometry, GeometryBatch, Gi, GiConfig, GiError, Grid, SurfaceMaterial,
    /// # };
    /// # let corners = [[0.1_f32, 0.1, 0.1], [0.1, 0.1, 0.9], [0.9, 0.1, 0.1]];
    /// # let positions = upload(&device, "positions", &corners);
    /// # let indices = upload(&device, "indices", &[0_u32, 1, 2]);
    /// # let materials = vec![SurfaceMaterial::default()];
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// let draws = vec![Draw::new(0, 3, 0)];
    /// let batch = GeometryBatch::new((*positions).clone(), (*indices).clone(), draws);
    /// let geometry = Geometry::new(vec![batch], materials);
    /// let voxelized = gi.voxelize(&geometry, Timing::for_device(&device)).await?;
    /// assert!(voxelized.stats.voxels > 0 && !voxelized.times.is_empty());
    ///
    /// let nothing = gi.voxelize(&Geometry::default(), Timing::Off).await;
    /// assert!(matches!(nothing, Err(GiError::NothingToVoxelize { .. })));
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::NothingToVoxelize`] without a usable triangle, [`GiError::Limit`] if the voxels
    /// do not fit the device, [`GiError::Budget`] if they exceed the memory budget. After an error
    /// the previous voxels remain, unless there are dynamic draws.
    pub async fn voxelize(
        &mut self,
        geometry: &Geometry,
        timing: Timing,
    ) -> Result<Voxelized, GiError> {
        self.scene.forget_static();
        self.emitters.forget();
        self.voxelize_dynamic(geometry, timing).await
    }

    /// Like [`Self::voxelize`] after dynamic draws have changed, appeared or disappeared, but does
    /// not voxelize the static ones ([`Draw::is_static`](crate::Draw)) again: the same bits in less
    /// time.
    ///
    /// The vertices, indices and textures of static draws must not have changed since the last call
    /// of either function. If anything else about static draws has changed, such as a transform, a
    /// material or the buffers themselves, everything is voxelized; see
    /// [`VoxelizeStats::static_reused`].
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{Mat4, Vec3};
    /// # use lumivox::gpu::{Timing, upload};
    /// # use lumivox::{Draw, Geometry, GeometryBatch, Gi, GiConfig, Grid, SurfaceMaterial};
    /// # let corners = [[0.1_f32, 0.1, 0.1], [0.1, 0.1, 0.9], [0.9, 0.1, 0.1]];
    /// # let positions = upload(&device, "positions", &corners);
    /// # let indices = upload(&device, "indices", &[0_u32, 1, 2]);
    /// # let materials = vec![SurfaceMaterial::default()];
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// // A floor that stays, and a copy of it above that is going to move.
    /// let floor = Draw { is_static: true, ..Draw::new(0, 3, 0) };
    /// let lifted = |by: f32| {
    ///     let world_from_local = Mat4::from_translation(by * Vec3::Y);
    ///     Draw { world_from_local, ..Draw::new(0, 3, 0) }
    /// };
    /// let (positions, indices) = ((*positions).clone(), (*indices).clone());
    /// let batch = GeometryBatch::new(positions, indices, vec![floor, lifted(0.3)]);
    /// let mut geometry = Geometry::new(vec![batch], materials);
    /// gi.voxelize(&geometry, Timing::Off).await?;
    ///
    /// geometry.batches[0].draws[1] = lifted(0.5);
    /// let moved = gi.voxelize_dynamic(&geometry, Timing::Off).await?;
    /// assert!(moved.stats.static_reused);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// As [`Self::voxelize`].
    pub async fn voxelize_dynamic(
        &mut self,
        geometry: &Geometry,
        timing: Timing,
    ) -> Result<Voxelized, GiError> {
        // Boxed, since its state is too large for the callers' futures.
        Box::pin(async {
            let mut recorder = Recorder::with_timing(&self.device, &self.queue, timing);
            let Self { device, voxelizer, scene, .. } = self;
            let is_reused = voxelizer.begin(device, scene, geometry).await?;
            loop {
                self.voxelize_frame(&mut recorder, geometry)?;
                self.scene.refuse_nothing(geometry)?;
                let status = || self.voxel_status();
                if !known(&mut recorder, &self.scene, status).await?.is_late {
                    break;
                }
            }
            (self.geometry, self.is_refused) = (Some(geometry.version()), false);
            let Self { voxelizer, scene, .. } = self;
            let stats = voxelizer.complete(&mut recorder, scene, geometry, is_reused).await?;
            self.grow_octree(&mut recorder)?;
            if let Some(octree) = self.volume.octree_mut().filter(|_| !self.scene.has_moving()) {
                octree.trim();
            }
            Ok(Voxelized { stats, times: recorder.finish().await? })
        })
        .await
    }

    /// Queues the kernels that a geometry and cones with these settings need for
    /// [`Pipelines::compile`](crate::gpu::Pipelines::compile): without bounces only kernels of
    /// direct light, with `in_frames` also those that only [`Self::frame`] runs. Other kernels are
    /// compiled on first use.
    ///
    /// # Errors
    /// [`GiError::Shader`] if a kernel does not link, which is a bug in this crate.
    pub fn prepare(
        &self,
        geometry: &Geometry,
        bounces: u32,
        in_frames: bool,
        settings: &TraceSettings,
    ) -> Result<(), GiError> {
        let has_emitters = self.draws_emitters() && Emitters::are_in(geometry);
        if has_emitters {
            self.emitters.expect(&self.device);
        }
        if in_frames {
            // Shadows may change their method at any time.
            self.lighting.expect_shadow_rays(&self.device);
        }
        if bounces > 0 {
            self.link_cones(settings.resolution, settings.temporal)?;
            self.lighting.expect_bounces(&self.device, has_emitters, in_frames);
            self.tracer.expect(&self.device, has_emitters, settings.specular);
        }
        Ok(())
    }

    /// `true` if gathers sample emitters directly. A caller's own cones find them in the volume
    /// instead.
    fn draws_emitters(&self) -> bool {
        self.config.cones.is_none()
    }

    /// Lists the emitters of a geometry.
    fn list_emitters(
        &mut self,
        recorder: &mut Recorder<'_>,
        geometry: &Geometry,
    ) -> Result<(), GiError> {
        if self.draws_emitters() && self.emitters.record(recorder, geometry)? {
            self.volume.bind_emitters(&self.device, self.emitters.list());
        }
        Ok(())
    }

    /// Binds lights for [`Self::light`] and [`Self::trace`]. `environment` is what lies outside the
    /// grid: a radiance, or an [`EnvironmentLight`] with a map. The map's brightest parts
    /// ([`EnvironmentMap::lights`]) are lights as well: they are added after `lights`, with cone
    /// shadows, unless `lights` contains them. `shadows` are maps for lights with
    /// [`Shadow::Map`](crate::Shadow), or `None`. [`Lights::update`] changes the lights.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::{Gi, GiConfig, Grid, Light, LightSource, Shadow};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// let lamp = |x| LightSource::Point {
    ///     position: Vec3::new(x, 0.9, 0.5),
    ///     intensity: Vec3::splat(100.0),
    ///     radius_m: 0.05,
    ///     range_m: None,
    /// };
    /// let light = |x| Light { source: lamp(x), shadow: Shadow::Cone };
    /// let mut lights = gi.bind_lights(&[light(0.2)], Vec3::ZERO, None);
    /// // In the next frame it has moved.
    /// lights.update(&queue, &[light(0.3)], Vec3::ZERO, None);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn bind_lights<'a>(
        &self,
        lights: &[Light],
        environment: impl Into<EnvironmentLight<'a>>,
        shadows: impl Into<ShadowSource<'a>>,
    ) -> Lights {
        let (layout, white) = (&self.lights_layout, &self.white);
        let lights =
            Lights::new(&self.device, layout, lights, environment.into(), white, shadows.into());
        if lights.has_cone_shadows {
            self.lighting.expect_shadow_rays(&self.device);
        }
        lights
    }

    /// Lights the voxels: direct light and emission, then bounces.
    ///
    /// `bounces` is the number of gathers of light, including the one that [`Self::trace`] does on
    /// screen: 0 leaves indirect light out, 1 is one bounce of the lights (and the direct light of
    /// emissive surfaces and of the environment, which arrives by gathers), each further one adds a
    /// bounce. From 8 on, gathers are accelerated, and 30 to 40 % fewer bring the same light.
    /// The cost grows in proportion to gathers. Voxels gather with the diffuse cones of `settings`.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::Vec3;
    /// # use lumivox::gpu::{Recorder, Timing};
    /// # use lumivox::{Gi, GiConfig, GiError, Grid, TraceSettings};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let mut gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// let mut recorder = Recorder::new(&device, &queue);
    /// gi.light(&mut recorder, &lights, 4, &TraceSettings::default())?;
    /// recorder.submit();
    ///
    /// let mut recorder = Recorder::new(&device, &queue);
    /// let settings = TraceSettings { diffuse_cones: 7, ..TraceSettings::default() };
    /// let refused = gi.light(&mut recorder, &lights, 4, &settings);
    /// assert!(matches!(refused, Err(GiError::Setting { .. })));
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] when a setting is out of range.
    pub fn light(
        &mut self,
        recorder: &mut Recorder,
        lights: &Lights,
        bounces: u32,
        settings: &TraceSettings,
    ) -> Result<(), GiError> {
        settings.validate()?;
        self.bounces = bounces;
        self.light_step(recorder, lights, Budget::Bounces(bounces), settings);
        Ok(())
    }

    /// Sets the values of the [`ConeModel`](crate::hooks::ConeModel) for later calls of
    /// [`Self::light`] and [`Self::trace`]. The model itself cannot change.
    pub fn set_cone_values(&mut self, values: [f32; 4]) {
        self.cone_values = values;
        self.content += 1;
    }

    /// For measurements: makes the next call of [`Self::light`] store and filter all cells, even
    /// those whose light has not changed.
    pub fn forget_light(&mut self) {
        if let Some(changes) = &mut self.changes {
            changes.forget();
        }
        self.lighting.disturb();
    }

    /// Changed cells, a bit each, laid out as
    /// [`VoxelList::occupancy`](crate::voxels::VoxelList::occupancy); `None` without cells
    /// ([`GiConfig::has_cells`]) and before there is a list. After [`Self::light`]: the cells that
    /// it wrote, with a [`ConeModel`](crate::hooks::ConeModel) those of the last gather, because
    /// their content or a finer cell's had changed. After a voxelization: the cells whose surface
    /// has changed, including removed ones.
    pub fn changed_cells(&self) -> Option<&Buffer> {
        self.changes.as_ref()?.bits()
    }
}

/// Checks for the bindings and workgroup sizes that the kernels need: WebGPU guarantees them, but
/// engines may request less.
fn check_limits(limits: &wgpu::Limits) -> Result<(), GiError> {
    let counts = |name: &str| {
        ["_per_shader_stage", "_compute_", "bind_groups"].iter().any(|part| name.contains(part))
    };
    let mut result = Ok(());
    wgpu::Limits::default().check_limits_with_fail_fn(limits, false, |limit, needed, available| {
        if result.is_ok() && counts(limit) {
            result = Err(GiError::Limit {
                what: "lighting voxels".to_owned(),
                needed,
                unit: "as WebGPU guarantees",
                limit,
                available,
                remedy: "ask for a device with WebGPU's default limits".to_owned(),
            });
        }
    });
    result
}
