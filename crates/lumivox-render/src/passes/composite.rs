//! One frame's picture from its parts, or a view of one of them.
//!
//! Outgoing radiance is emission, plus direct light from lamps and sun, plus albedo / pi times the
//! gathered irradiance (less the part that the gloss reflects before it enters), plus the radiance
//! of the glossy cones. The background is the environment. Coloured glass in front of all this
//! tints the sum.

use bytemuck::{Pod, Zeroable};
use glam::Vec2;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, upload,
};
use lumivox::{Gi, GiView, Lights};

use crate::View;
use crate::gpu::textures::ScreenTextures;
use crate::passes::direct::DirectTargets;
use crate::passes::gbuffer::GBufferTargets;

/// Format of pictures before tone mapping: full floats, so that the mean over frames is exact.
pub const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// A single-channel format that every device can read and write in place.
const ILLUMINANCE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// `CompositeSettings` of `composite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CompositeSettings {
    pub(crate) shown: u32,
    pub(crate) has_cones: u32,
    pub(crate) weight: f32,
    pub(crate) is_further: u32,
    pub(crate) to_traced: [f32; 2],
    padding: [u32; 2],
}

/// Combines the parts of a picture.
#[derive(Debug)]
pub struct CompositePass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    /// Bound in place of records if no light of earlier frames is stored.
    no_records: TextureView,
}

/// One frame's picture.
#[derive(Debug)]
pub struct CompositeTargets {
    /// Radiance or a quantity in rgb; in a 1 where there is a surface, 0 elsewhere.
    pub picture: TextureView,
    /// The mean over frames of the surface's illuminance, in lux divided by the unit of radiance;
    /// negative without a surface.
    pub illuminance: Texture,
    settings: Buffer,
    group: BindGroup,
}

/// One sample of a picture: its view, its light, and its position in the pixel.
#[derive(Clone, Copy, Debug)]
pub struct Composed {
    /// The view that the picture shows.
    pub view: View,
    /// Whether cones were traced for the frame.
    pub has_cones: bool,
    /// The sample's share in the new mean of illuminances.
    pub weight: f32,
    /// For a further sample of the frame: the offset from its position in the pixel to that of the
    /// traced sample, in pixels.
    pub to_traced: Option<Vec2>,
}

impl CompositePass {
    /// Creates the pipeline.
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
            .storage_texture_in_place(ILLUMINANCE_FORMAT)
            .storage_texture_in_place(wgpu::TextureFormat::R32Uint)
            .build(device, "composite");
        let groups = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let kernel = Kernel::new(device, shaders, "render::passes::composite", "main", &groups)?;
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
        Ok(Self { kernel, layout, no_records: no_records.view() })
    }

    /// Placeholder to bind if there are no records.
    pub(crate) fn no_records(&self) -> &TextureView {
        &self.no_records
    }

    pub(crate) fn targets(
        &self,
        device: &wgpu::Device,
        textures: &mut ScreenTextures<'_>,
        gbuffer: &GBufferTargets,
        direct: &DirectTargets,
        view: &GiView,
    ) -> CompositeTargets {
        let picture = textures.storage("picture", PICTURE_FORMAT);
        let usage = wgpu::TextureUsages::STORAGE_BINDING;
        let illuminance = textures.create("illuminance", ILLUMINANCE_FORMAT, usage);
        let traced_depth = textures.storage("traced depth", ILLUMINANCE_FORMAT);
        let traced_normal = textures.storage("traced normal", wgpu::TextureFormat::R32Uint);
        let settings = upload(device, "composite", &[CompositeSettings::zeroed()]);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&settings)
            .view(&direct.diffuse)
            .view(&direct.specular)
            .view(view.irradiance())
            .view(view.specular())
            .view(&gbuffer.tint)
            .view(view.records().unwrap_or(&self.no_records))
            .view(&picture)
            .view(&illuminance.view())
            .view(&traced_depth)
            .view(&traced_normal)
            .build(device, "composite");
        CompositeTargets { picture, illuminance, settings, group }
    }

    /// Composes the picture. Settings take effect at the next submission, so record one sample per
    /// recorder.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        (gi, lights, view): (&Gi, &Lights, &GiView),
        targets: &CompositeTargets,
        of: Composed,
    ) {
        let settings = CompositeSettings {
            shown: of.view as u32,
            has_cones: u32::from(of.has_cones),
            weight: of.weight,
            is_further: u32::from(of.to_traced.is_some()),
            to_traced: of.to_traced.unwrap_or_default().to_array(),
            padding: [0; 2],
        };
        recorder.queue().write_buffer(&targets.settings, 0, bytemuck::bytes_of(&settings));
        let groups = [gi.globals(), &targets.group, &lights.group, view.group()];
        self.kernel.run(recorder, &groups, [view.size().x, view.size().y, 1]);
    }
}
