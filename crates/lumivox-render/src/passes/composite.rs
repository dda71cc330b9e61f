//! One frame's picture from its parts, or a view of one of them.
//!
//! Outgoing radiance is emission, plus light straight from lamps and sun, plus albedo / pi times
//! the gathered irradiance (less the part that the gloss reflects before it enters), plus the
//! radiance of the glossy cones. The background is the environment. Coloured glass in front of all
//! this tints the sum.

use bytemuck::{Pod, Zeroable};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, upload,
};
use lumivox::{GBuffer, Gi, Lights, TraceTargets};

use crate::View;
use crate::gpu::textures::ScreenTextures;
use crate::passes::direct::DirectTargets;
use crate::passes::gbuffer::GBufferTargets;

/// Format of pictures before tone mapping: full floats, so that the mean over frames is exact.
pub const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// A format of one number a pixel that every device can read and write in place.
const ILLUMINANCE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// `CompositeSettings` of `composite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CompositeSettings {
    pub(crate) shown: u32,
    pub(crate) has_cones: u32,
    pub(crate) frames: u32,
    padding: u32,
}

/// Puts the parts of a picture together.
#[derive(Debug)]
pub struct CompositePass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    /// Takes the place of group 0: compositing does not use the volume.
    nothing: BindGroup,
    /// Takes the place of records where no light of earlier frames is kept.
    no_records: TextureView,
}

/// One frame's picture.
#[derive(Debug)]
pub struct CompositeTargets {
    /// Radiance or a quantity in rgb; in a 1 where there is a surface, 0 elsewhere.
    pub picture: TextureView,
    /// The mean over frames of the surface's illuminance, in lux divided by the unit of radiance; negative where there is no
    /// surface.
    pub illuminance: Texture,
    settings: Buffer,
    group: BindGroup,
}

impl CompositePass {
    /// Makes the pipeline.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary, gi: &Gi) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute().storage();
        let layout = (0..5)
            .fold(layout, |layout, _| layout.texture_2d_unfilterable())
            .texture(wgpu::TextureViewDimension::D2, wgpu::TextureSampleType::Uint)
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT)
            .storage_texture_in_place(ILLUMINANCE_FORMAT)
            .build(device, "composite");
        let nothing = LayoutBuilder::compute().build(device, "nothing");
        let groups = [&nothing, &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let kernel = Kernel::new(device, shaders, "render::passes::composite", "main", &groups)?;
        let nothing = BindGroupBuilder::new(&nothing).build(device, "nothing");
        let no_records = Texture::new(
            device,
            &wgpu::TextureDescriptor {
                label: Some("no records"),
                size: wgpu::Extent3d::default(),
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rg32Uint,
                usage: wgpu::TextureUsages::TEXTURE_BINDING,
                view_formats: &[],
            },
        );
        Ok(Self { kernel, layout, nothing, no_records: no_records.view() })
    }

    /// In place of records where there are none.
    pub(crate) fn no_records(&self) -> &TextureView {
        &self.no_records
    }

    pub(crate) fn targets(
        &self,
        device: &wgpu::Device,
        textures: &mut ScreenTextures<'_>,
        gbuffer: &GBufferTargets,
        direct: &DirectTargets,
        traced: &TraceTargets,
    ) -> CompositeTargets {
        let picture = textures.storage("picture", PICTURE_FORMAT);
        let usage = wgpu::TextureUsages::STORAGE_BINDING;
        let illuminance = textures.create("illuminance", ILLUMINANCE_FORMAT, usage);
        let settings = upload(device, "composite", &[CompositeSettings::zeroed()]);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&settings)
            .view(&direct.diffuse)
            .view(&direct.specular)
            .view(&traced.irradiance)
            .view(&traced.specular)
            .view(&gbuffer.tint)
            .view(traced.records.as_ref().unwrap_or(&self.no_records))
            .view(&picture)
            .view(&illuminance.view())
            .build(device, "composite");
        CompositeTargets { picture, illuminance, settings, group }
    }

    /// Makes the picture; `has_cones` says whether cones were traced for it, `frames` is the number
    /// of frames in the mean before it. The view takes effect at the next submission: one frame per
    /// recorder.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        lights: &Lights,
        gbuffer: &GBuffer,
        targets: &CompositeTargets,
        (view, has_cones, frames): (View, bool, u32),
    ) {
        let has_cones = u32::from(has_cones);
        let settings = CompositeSettings { shown: view as u32, has_cones, frames, padding: 0 };
        recorder.queue().write_buffer(&targets.settings, 0, bytemuck::bytes_of(&settings));
        let groups = [&self.nothing, &targets.group, &lights.group, &gbuffer.group];
        self.kernel.run(recorder, &groups, [gbuffer.size.x, gbuffer.size.y, 1]);
    }
}
