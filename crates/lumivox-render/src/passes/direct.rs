//! Direct light on the visible surfaces from lamps and sun: Lambert's diffuse reflection and the
//! microfacet gloss of `package::trace::brdf`, per pixel and light.

use lumivox::gpu::{
    BindGroupBuilder, LayoutBuilder, Pipelines, Recorder, ShaderError, ShaderLibrary, TextureView,
};
use lumivox::internal::{KernelVariants, TRACES_SHADOWS};
use lumivox::{Gi, GiView, Lights};

use crate::gpu::textures::ScreenTextures;
use crate::passes::near_shadows::NearShadows;

const DIFFUSE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// A highlight of a lamp may exceed the largest half float a hundred times.
const SPECULAR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// Evaluates the analytic lights.
#[derive(Debug)]
pub struct DirectPass {
    /// With and without rays for shadows.
    kernels: KernelVariants,
    layout: wgpu::BindGroupLayout,
}

/// Direct light at each pixel.
#[derive(Debug)]
pub struct DirectTargets {
    /// Diffusely reflected radiance in rgb, the unblocked share of the light in a.
    pub diffuse: TextureView,
    /// Glossily reflected radiance in rgb, the illuminance of the surface in a.
    pub specular: TextureView,
}

impl DirectPass {
    /// Creates the pipeline.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary, gi: &Gi) -> Result<Self, ShaderError> {
        let d2 = wgpu::TextureViewDimension::D2;
        let layout = LayoutBuilder::compute()
            .storage_texture(d2, DIFFUSE_FORMAT)
            .storage_texture(d2, SPECULAR_FORMAT)
            .storage()
            .depth_2d_array()
            .build(device, "direct light");
        let groups = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let (feature, module) = (TRACES_SHADOWS, "render::passes::direct");
        let kernels = KernelVariants::new(device, shaders, feature, module, "main", &groups)?;
        Ok(Self { kernels, layout })
    }

    /// Queues a variant for compilation.
    pub(crate) fn expect(&self, device: &Pipelines, traces_shadows: bool) {
        self.kernels.expect(device, traces_shadows);
    }

    pub(crate) fn targets(textures: &mut ScreenTextures<'_>) -> DirectTargets {
        let diffuse = textures.storage("direct diffuse light", DIFFUSE_FORMAT);
        let specular = textures.storage("direct specular light", SPECULAR_FORMAT);
        DirectTargets { diffuse, specular }
    }

    /// Lights the G-buffer. The shadow maps around the camera must be drawn before.
    pub(crate) fn record(
        &self,
        device: &wgpu::Device,
        recorder: &mut Recorder,
        gi: &Gi,
        (lights, near): (&Lights, &NearShadows),
        view: &GiView,
        targets: &DirectTargets,
    ) {
        let group = BindGroupBuilder::new(&self.layout)
            .view(&targets.diffuse)
            .view(&targets.specular)
            .buffer(&near.layers)
            .view(&near.maps)
            .build(device, "direct light");
        let groups = [gi.globals(), &group, &lights.group, view.group()];
        self.kernels.variant(lights.has_cone_shadows).run(
            recorder,
            &groups,
            [view.size().x, view.size().y, 1],
        );
    }
}
