//! Cones from the caller's G-buffer.

use glam::UVec2;

use super::Gi;
use crate::GiError;
use crate::cones::{TraceResolution, TraceSettings};
use crate::gpu::Recorder;
use crate::light::Lights;
use crate::trace::{Bound, GBuffer, GiView, ScreenSettings};

impl Gi {
    /// A camera: its G-buffer of `size` pixels, and the textures that [`Self::trace`] writes to, at
    /// the settings' resolution, with a history of earlier frames if [`TraceSettings::temporal`] is
    /// set. With a history each trace continues from the previous one: submit frames in the order
    /// in which they were recorded.
    ///
    /// The G-buffer has Lumivox's own layout, or that of [`crate::GiConfig::gbuffer`]'s module:
    ///
    /// ```
    /// # pollster::block_on(async {
    /// # let (device, queue) = lumivox::gpu::open_device().await?;
    /// # use glam::{Mat4, UVec2, Vec3};
    /// # use lumivox::gpu::Recorder;
    /// # use lumivox::hooks::Mounted;
    /// # use lumivox::{CameraView, GBuffer, Gi, GiConfig, Grid, TraceSettings, wgpu};
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
    /// let lights = gi.bind_lights(&[], Vec3::ONE, None);
    /// let settings = TraceSettings::default();
    /// let mut view = gi.view(GBuffer::Own(&[depth.into()]), size, &settings);
    /// view.set_camera(&queue, CameraView::new(Mat4::IDENTITY, Vec3::ZERO));
    /// let mut recorder = Recorder::new(&device, &queue);
    /// gi.trace(&mut recorder, &mut view, &lights)?;
    /// recorder.submit();
    /// # Ok::<(), lumivox::GiError>(())
    /// # }).unwrap();
    /// ```
    pub fn view<'a>(
        &self,
        gbuffer: impl Into<GBuffer<'a>>,
        size: UVec2,
        settings: &TraceSettings,
    ) -> GiView {
        let layout = &self.gbuffer_layout;
        let view = GiView::new(&self.device, layout, gbuffer.into(), size, settings);
        // Links kernels early, to be compiled with all others; tracing reports errors.
        let _ = self.link_cones(view.resolution(), view.is_temporal());
        view
    }

    /// Binds other textures of the same size to a view; call it before [`GiView::set_camera`].
    pub fn bind_gbuffer<'a>(&self, view: &mut GiView, gbuffer: impl Into<GBuffer<'a>>) {
        view.bind(&self.device, &self.gbuffer_layout, gbuffer.into());
    }

    /// Links the kernels for cones at this resolution, with or without a history.
    pub(super) fn link_cones(
        &self,
        resolution: TraceResolution,
        is_temporal: bool,
    ) -> Result<(), GiError> {
        let (tracer, device, shaders) = (&self.tracer, &self.device, &self.shaders);
        let layouts = [self.volume.globals_layout(), &self.lights_layout, &self.gbuffer_layout];
        if resolution == TraceResolution::Half {
            tracer.prepare_half(device, shaders, layouts)?;
        }
        if is_temporal {
            tracer.prepare_temporal(device, shaders, layouts)
        } else {
            tracer.prepare_mean(device, shaders, layouts)
        }
    }

    /// Traces the cones of one frame from the G-buffer of a view into its textures. Several traces
    /// may be recorded before one submission, each with its own settings; of several traces of one
    /// view only the last result remains.
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
    /// let views = GBufferViews {
    ///     depth: &depth,
    ///     normals: &normals,
    ///     diffuse: &diffuse,
    ///     specular: &specular,
    ///     emission: &emission,
    ///     motion: None,
    /// };
    /// let mut view = gi.view(views, size, &settings);
    /// for _ in 0..2 {
    ///     view.set_camera(&queue, CameraView::new(clip_from_world, position));
    ///     let mut encoder = device.create_command_encoder(&Default::default());
    ///     // The engine's G-buffer pass, then the cones, then its shading, which reads
    ///     // `view.irradiance()` and `view.specular()`.
    ///     let mut recorder = Recorder::on(&device, &queue, &mut encoder);
    ///     gi.trace(&mut recorder, &mut view, &lights)?;
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
        view: &mut GiView,
        lights: &Lights,
    ) -> Result<(), GiError> {
        view.settings.validate()?;
        self.link_cones(view.resolution(), view.is_temporal())?;
        let cones = (&view.settings, self.cone_values);
        let voxel_size_m = self.config.grid.voxel_size_m;
        let light = (self.bounces, self.volume.is_marched());
        let screen = ScreenSettings::new(cones, view.resolution(), voxel_size_m, light);
        let bound = Bound {
            globals: self.volume.globals(),
            lights: &lights.group,
            gbuffer: view.group(),
            has_emitters: self.emitters.has_any(),
            content: [self.content, lights.version],
        };
        self.tracer.run(recorder, &bound, view.targets(), &screen);
        view.set_traced();
        Ok(())
    }
}
