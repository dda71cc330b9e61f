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
    /// Creates the textures that [`Self::trace`] writes to, at the settings' resolution, with a
    /// history of earlier frames if the settings ask for one ([`TraceSettings::temporal`]). With a
    /// history each trace continues from the previous one: submit frames in the order in which they
    /// were recorded, and set [`CameraView::previous_clip_from_world`] to that of the previous
    /// frame.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{UVec2, Vec3};
    /// # use lumivox::{Gi, GiConfig, Grid, TraceSettings};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let gi = Gi::new(&device, &queue, GiConfig::new(grid))?;
    /// let targets = gi.targets(UVec2::new(640, 360), &TraceSettings::default());
    /// assert_eq!(targets.size(), UVec2::new(640, 360));
    /// assert!(targets.memory() > 0);
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn targets(&self, size: UVec2, settings: &TraceSettings) -> TraceTargets {
        let targets = TraceTargets::new(&self.device, size, settings);
        // Compiled early, with everything else; tracing reports its errors.
        let _ = self.prepare_targets(&targets);
        targets
    }

    fn prepare_targets(&self, targets: &TraceTargets) -> Result<(), GiError> {
        let (tracer, device, shaders) = (&self.tracer, &self.device, &self.shaders);
        let layouts = [self.volume.globals_layout(), &self.lights_layout, &self.gbuffer_layout];
        if targets.resolution() == TraceResolution::Half {
            tracer.prepare_half(device, shaders, layouts)?;
        }
        if targets.is_temporal() {
            tracer.prepare_temporal(device, shaders, layouts)
        } else {
            tracer.prepare_reconstruct(device, shaders, layouts)
        }
    }

    /// Binds the caller's G-buffer for [`Self::trace`].
    pub fn bind_gbuffer(&self, views: GBufferViews<'_>, view: CameraView) -> GBuffer {
        GBuffer::new(&self.device, &self.gbuffer_layout, views, view)
    }

    /// Binds the resources of [`crate::GiConfig::gbuffer`]'s module, in the order of its bindings,
    /// for [`Self::trace`]. wgpu reports resources that do not fit the bindings.
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{Mat4, UVec2, Vec3};
    /// # use lumivox::gpu::Recorder;
    /// # use lumivox::hooks::Mounted;
    /// # use lumivox::{CameraView, Gi, GiConfig, Grid, TraceSettings, wgpu};
    /// # let grid = Grid::fit(Vec3::ZERO, Vec3::ONE, 16, Vec3::ZERO)?;
    /// # let size = UVec2::new(8, 8);
    /// # let depth = device.create_texture(&wgpu::TextureDescriptor {
    /// #     label: None,
    /// #     size: wgpu::Extent3d { width: 8, height: 8, depth_or_array_layers: 1 },
    /// #     mip_level_count: 1,
    /// #     sample_count: 1,
    /// #     dimension: wgpu::TextureDimension::D2,
    /// #     format: wgpu::TextureFormat::Depth32Float,
    /// #     usage: wgpu::TextureUsages::TEXTURE_BINDING,
    /// #     view_formats: &[],
    /// # });
    /// # let depth = depth.create_view(&Default::default());
    /// // An engine of floors: all that it draws is a depth.
    /// let module = "
    ///     import package::trace::surface::{Specular, Surface};
    ///     import package::trace::view::{camera_motion, position_from_depth};
    ///
    ///     @group(3) @binding(1) var depth_texture: texture_depth_2d;
    ///
    ///     fn load_surface(pixel: vec2u) -> Surface {
    ///         let depth = textureLoad(depth_texture, pixel, 0);
    ///         let up = vec3f(0.0, 1.0, 0.0);
    ///         return Surface(position_from_depth(pixel, max(depth, 1e-7)), depth, up, up);
    ///     }
    ///
    ///     fn load_specular(pixel: vec2u) -> Specular {
    ///         return Specular(vec3f(0.04), 1.0, 0.0, 0.0);
    ///     }
    ///
    ///     fn load_motion(pixel: vec2u, position_in_world: vec3f) -> vec2f {
    ///         return camera_motion(pixel, position_in_world);
    ///     }";
    /// let texture = wgpu::BindingType::Texture {
    ///     sample_type: wgpu::TextureSampleType::Depth,
    ///     view_dimension: wgpu::TextureViewDimension::D2,
    ///     multisampled: false,
    /// };
    /// let gbuffer = Some(Mounted::new(module, [texture]));
    /// let gi = Gi::new(&device, &queue, GiConfig { gbuffer, ..GiConfig::new(grid) })?;
    /// let view = CameraView::new(Mat4::IDENTITY, Vec3::ZERO, size);
    /// let gbuffer = gi.bind_own_gbuffer(&[depth.into()], view);
    ///
    /// let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// let settings = TraceSettings::default();
    /// let targets = gi.targets(size, &settings);
    /// let mut recorder = Recorder::new(&device, &queue);
    /// gi.trace(&mut recorder, &gbuffer, &lights, &settings, &targets)?;
    /// recorder.submit();
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn bind_own_gbuffer(&self, resources: &[Resource], view: CameraView) -> GBuffer {
        GBuffer::own(&self.device, &self.gbuffer_layout, resources, view)
    }

    /// Traces the cones of one frame from the G-buffer into the targets. The settings must have the
    /// resolution that the targets were created for. Several traces may be recorded before one
    /// submission, each with its own settings; of those into the same targets the last one's result
    /// stays. For several cameras bind one G-buffer each.
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
    ///     // The engine's G-buffer pass, then the cones, then its shading, which reads the
    ///     // targets.
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
        let light = (self.bounces, self.volume.is_marched());
        let screen = ScreenSettings::new(cones, resolution, voxel_size_m, light);
        let bound = Bound {
            globals: self.volume.globals(),
            lights: &lights.group,
            gbuffer,
            has_emitters: self.emitters.has_any(),
            hide_emission: &|recorder, hides| self.hide_emission(recorder, hides),
            content: [self.content, lights.version],
        };
        self.tracer.run(recorder, &bound, targets, &screen);
        Ok(())
    }

    /// Makes the volume show only reflected light, or all light again, to what is recorded next.
    pub(super) fn hide_emission(&self, recorder: &mut Recorder<'_>, hides: bool) {
        self.lighting.hide_emission(recorder, (&self.volume, &self.changes), hides);
    }
}
