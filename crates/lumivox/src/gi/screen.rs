//! Cones from the caller's G-buffer.

use glam::UVec2;

use super::Gi;
use crate::GiError;
use crate::cones::{TraceResolution, TraceSettings};
use crate::gpu::Recorder;
use crate::light::Lights;
use crate::mounted::Resource;
use crate::trace::{Bound, CameraView, GBuffer, GBufferViews, ScreenSettings, TraceTargets};

impl Gi {
    /// Textures for [`Self::trace`] to write to, for a resolution and, if the settings ask for it, with a memory of earlier
    /// frames.
    pub fn targets(&self, size: UVec2, settings: &TraceSettings) -> TraceTargets {
        let targets = TraceTargets::new(&self.device, size, settings);
        // Early, so that it is compiled with all else; tracing tells what is wrong.
        let _ = self.prepare_targets(&targets);
        targets
    }

    fn prepare_targets(&self, targets: &TraceTargets) -> Result<(), GiError> {
        if targets.resolution() == TraceResolution::Half {
            self.prepare_half()?;
        }
        if targets.has_history() {
            let layouts = [self.volume.globals_layout(), &self.gbuffer_layout];
            self.tracer.prepare_memory(&self.device, &self.shaders, layouts)?;
        }
        Ok(())
    }

    fn prepare_half(&self) -> Result<(), GiError> {
        let layouts = [self.volume.globals_layout(), &self.lights_layout, &self.gbuffer_layout];
        self.tracer.prepare_half(&self.device, &self.shaders, layouts)
    }

    /// Binds the caller's G-buffer for [`Self::trace`].
    pub fn bind_gbuffer(&self, views: GBufferViews<'_>, view: CameraView) -> GBuffer {
        GBuffer::new(&self.device, &self.gbuffer_layout, views, view)
    }

    /// Binds what [`crate::GiConfig::gbuffer`]'s module reads, in the order of its bindings, for [`Self::trace`]. wgpu reports
    /// resources that do not fit the bindings.
    pub fn bind_own_gbuffer(&self, resources: &[Resource], view: CameraView) -> GBuffer {
        GBuffer::own(&self.device, &self.gbuffer_layout, resources, view)
    }

    /// Traces the cones of one frame from the G-buffer into the targets. The settings' resolution is that of
    /// the targets. Several traces may be recorded before one submission, each with settings of its own; into the same
    /// targets the last one's result stays. For several cameras bind as many G-buffers.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{Mat4, UVec2, Vec3};
    /// # use lumivox::gpu::Recorder;
    /// # use lumivox::wgpu::TextureFormat::{Depth32Float, Rgba16Float};
    /// # use lumivox::{CameraView, GBufferViews, Gi, GiConfig, Grid, TraceSettings};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// # let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// # let size = UVec2::new(8, 8);
    /// # let texture = |format| {
    /// #     let texture = device.create_texture(&lumivox::wgpu::TextureDescriptor {
    /// #         label: None,
    /// #         size: lumivox::wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
    /// #         mip_level_count: 1,
    /// #         sample_count: 1,
    /// #         dimension: lumivox::wgpu::TextureDimension::D2,
    /// #         format,
    /// #         usage: lumivox::wgpu::TextureUsages::TEXTURE_BINDING,
    /// #         view_formats: &[],
    /// #     });
    /// #     texture.create_view(&Default::default())
    /// # };
    /// # let depth = texture(Depth32Float);
    /// # let [normals, diffuse, specular, emission] = [Rgba16Float; 4].map(texture);
    /// # let clip_from_world = Mat4::IDENTITY;
    /// # let position = Vec3::ZERO;
    /// let settings = TraceSettings::default();
    /// let targets = gi.targets(size, &settings);
    /// let mut view = CameraView::new(clip_from_world, position, size);
    /// let views = GBufferViews {
    ///     depth: &depth,
    ///     normals: &normals,
    ///     diffuse: &diffuse,
    ///     specular: &specular,
    ///     emission: &emission,
    ///     motion: None,
    /// };
    /// let gbuffer = gi.bind_gbuffer(views, view);
    /// for frame in 0..2 {
    ///     view.previous_clip_from_world = view.clip_from_world;
    ///     view.frame = frame;
    ///     gbuffer.set_camera(&queue, view);
    ///     let mut encoder = device.create_command_encoder(&Default::default());
    ///     // The engine's G-buffer pass, then the cones, then its shading, which reads the targets.
    ///     let mut recorder = Recorder::on(&device, &queue, &mut encoder);
    ///     gi.trace(&mut recorder, &gbuffer, &lights, &settings, &targets)?;
    ///     drop(recorder);
    ///     queue.submit([encoder.finish()]);
    /// }
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    ///
    /// # Errors
    /// [`GiError::Setting`] when a setting is out of range.
    pub fn trace(
        &self,
        recorder: &mut Recorder,
        gbuffer: &GBuffer,
        lights: &Lights,
        settings: &TraceSettings,
        targets: &TraceTargets,
    ) -> Result<(), GiError> {
        settings.validate()?;
        self.prepare_targets(targets)?;
        let cones = (settings, self.cone_values);
        let resolution = targets.resolution();
        let voxel_size_m = self.config.grid.voxel_size_m;
        let screen = ScreenSettings::new(cones, resolution, voxel_size_m, self.bounces);
        let bound = Bound { globals: self.volume.globals(), lights: &lights.group, gbuffer };
        self.tracer.run(recorder, &bound, targets, &screen);
        Ok(())
    }
}
