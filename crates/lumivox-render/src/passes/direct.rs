//! Light that reaches the visible surfaces straight from lamps and sun: Lambert's diffuse
//! reflection and the microfacet gloss of `package::trace::brdf`, per pixel and light.

use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, TextureView,
};
use lumivox::{GBuffer, Gi, Lights};

use crate::gpu::textures::ScreenTextures;

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// Evaluates the analytic lights.
#[derive(Debug)]
pub struct DirectPass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
}

/// Direct light at each pixel.
#[derive(Debug)]
pub struct DirectTargets {
    /// Diffusely reflected radiance in rgb, the unblocked share of the light in a.
    pub diffuse: TextureView,
    /// Glossily reflected radiance in rgb, the illuminance of the surface in a.
    pub specular: TextureView,
    group: BindGroup,
}

impl DirectPass {
    /// Makes the pipeline.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary, gi: &Gi) -> Result<Self, ShaderError> {
        let d2 = wgpu::TextureViewDimension::D2;
        let layout = LayoutBuilder::compute()
            .storage_texture(d2, FORMAT)
            .storage_texture(d2, FORMAT)
            .build(device, "direct light");
        let groups = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let kernel = Kernel::new(device, shaders, "render::passes::direct", "main", &groups)?;
        Ok(Self { kernel, layout })
    }

    pub(crate) fn targets(
        &self,
        device: &wgpu::Device,
        textures: &mut ScreenTextures<'_>,
    ) -> DirectTargets {
        let diffuse = textures.storage("direct diffuse light", FORMAT);
        let specular = textures.storage("direct specular light", FORMAT);
        let group = BindGroupBuilder::new(&self.layout)
            .view(&diffuse)
            .view(&specular)
            .build(device, "direct light");
        DirectTargets { diffuse, specular, group }
    }

    /// Lights the G-buffer.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        gi: &Gi,
        lights: &Lights,
        gbuffer: &GBuffer,
        targets: &DirectTargets,
    ) {
        let groups = [gi.globals(), &targets.group, &lights.group, &gbuffer.group];
        self.kernel.run(recorder, &groups, [gbuffer.size.x, gbuffer.size.y, 1]);
    }
}
