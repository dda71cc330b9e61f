//! The passes of a frame, linked against one volume and created for one scene's materials.

use lumivox::Gi;
use lumivox::gpu::ShaderLibrary;

use crate::passes::composite::CompositePass;
use crate::passes::direct::DirectPass;
use crate::passes::figures::FiguresPass;
use crate::passes::gbuffer::GBufferPass;
use crate::passes::motion::MotionPass;
use crate::passes::shadow_maps::ShadowMapPass;
use crate::passes::targets::Targets;
use crate::scene::GpuScene;
use crate::{Gpu, RenderError, RenderSettings, ShadowMethod};

/// All passes that do not depend on the picture's size.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) shaders: ShaderLibrary,
    pub(super) gbuffer: GBufferPass,
    /// The shadow maps; `None` if shadows are traced by cones.
    pub(super) shadows: Option<ShadowMapPass>,
    pub(super) direct: DirectPass,
    pub(super) composite: CompositePass,
    pub(super) motion: MotionPass,
    /// `None` before the first request for figures.
    pub(super) figures: Option<FiguresPass>,
}

impl Passes {
    /// Links and creates all pipelines.
    pub(super) fn new(
        gpu: &Gpu,
        gi: &Gi,
        scene: &GpuScene,
        settings: &RenderSettings,
    ) -> Result<Self, RenderError> {
        let device = &gpu.pipelines;
        let shaders = crate::shaders::library(gi.shaders());
        let mut passes = Self {
            gbuffer: GBufferPass::new(device, &shaders, scene)?,
            shadows: None,
            direct: DirectPass::new(device, &shaders, gi)?,
            composite: CompositePass::new(device, &shaders, gi)?,
            motion: MotionPass::new(device, &shaders)?,
            figures: None,
            shaders,
        };
        passes.set_shadows(gpu, scene, settings.shadows)?;
        Ok(passes)
    }

    /// Switches to the other shadow method.
    pub(super) fn set_shadows(
        &mut self,
        gpu: &Gpu,
        scene: &GpuScene,
        method: ShadowMethod,
    ) -> Result<(), RenderError> {
        self.direct.expect(&gpu.pipelines, method == ShadowMethod::Cone);
        self.shadows = match method {
            ShadowMethod::Map => Some(ShadowMapPass::new(&gpu.pipelines, &self.shaders, scene)?),
            ShadowMethod::Cone => None,
        };
        Ok(())
    }

    /// Updates to the same scene, moved or with other materials of the same layout.
    pub(super) fn set_scene(&mut self, gpu: &Gpu, scene: &GpuScene) -> Result<(), RenderError> {
        self.gbuffer.set_scene(&gpu.pipelines, scene)?;
        if let Some(pass) = &mut self.shadows {
            pass.set_scene(&gpu.pipelines, scene)?;
        }
        Ok(())
    }

    /// Creates all resources of the picture's size.
    pub(super) async fn targets(
        &self,
        gpu: &Gpu,
        gi: &Gi,
        scene: &GpuScene,
        settings: &RenderSettings,
    ) -> Result<Targets, RenderError> {
        let size = settings.size;
        let is_tinted = scene.is_tinted();
        Targets::new(gpu, &self.shaders, gi, &self.composite, size, &settings.trace, is_tinted)
            .await
    }
}
