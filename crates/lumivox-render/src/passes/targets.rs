//! Everything that depends on the picture's size: textures, and the passes bound to them.

use glam::UVec2;
use lumivox::gpu::ShaderLibrary;
use lumivox::{Gi, GiView, TraceSettings};

use crate::gpu::memory::available_memory;
use crate::gpu::textures::ScreenTextures;
use crate::passes::accumulate::AccumulatePass;
use crate::passes::composite::{CompositePass, CompositeTargets};
use crate::passes::direct::{DirectPass, DirectTargets};
use crate::passes::gbuffer::GBufferTargets;
use crate::passes::overlay::OverlayPass;
use crate::passes::voxel_view::VoxelViewPass;
use crate::picture::tone_map::ToneMapPass;
use crate::renderer::beside::BesideView;
use crate::{Gpu, RenderError};

/// Everything that depends on the picture's size.
#[derive(Debug)]
pub(crate) struct Targets {
    pub(crate) gbuffer_textures: GBufferTargets,
    pub(crate) direct: DirectTargets,
    /// The camera with the G-buffer, and the cones' results.
    pub(crate) view: GiView,
    pub(crate) composite: CompositeTargets,
    pub(crate) voxel_view: VoxelViewPass,
    pub(crate) accumulate: AccumulatePass,
    pub(crate) tone_map: ToneMapPass,
    /// Other views of the same frames; empty until the first frame with such a view.
    pub(crate) beside: Vec<BesideView>,
    /// The overlay; `None` until there is something to draw.
    pub(crate) overlay: Option<OverlayPass>,
    /// Bytes of the textures of this crate and of the cones.
    pub(crate) bytes: u64,
}

/// Bytes a pixel of everything in [`Targets`] except the cones: G-buffer 36, direct light 24,
/// picture and mean 48, illuminance 4, traced surfaces 8, screen 4.
pub(crate) const BYTES_PER_PIXEL: u64 = 124;

/// Additional bytes a pixel for motion, if light of earlier frames is stored.
const MOTION_BYTES_PER_PIXEL: u64 = 4;

/// Bytes of the cones' textures for a picture of the given size.
pub(crate) fn trace_bytes(trace: &TraceSettings, size: UVec2) -> u64 {
    let motion = if trace.temporal { MOTION_BYTES_PER_PIXEL } else { 0 };
    u64::from(size.x) * u64::from(size.y) * motion + GiView::bytes(size, trace)
}

/// Additional bytes a pixel for the tint of coloured glass.
pub(crate) const TINT_BYTES_PER_PIXEL: u64 = 4;

impl Targets {
    /// Creates all targets; `is_tinted` is `true` if the scene has coloured glass.
    ///
    /// # Errors
    /// [`RenderError::OutOfMemory`] when the device has too little memory; also when a shader does
    /// not link.
    pub(crate) async fn new(
        gpu: &Gpu,
        shaders: &ShaderLibrary,
        gi: &Gi,
        composite: &CompositePass,
        size: UVec2,
        trace: &TraceSettings,
        is_tinted: bool,
    ) -> Result<Self, RenderError> {
        let tint = if is_tinted { TINT_BYTES_PER_PIXEL } else { 0 };
        let pixels = u64::from(size.x) * u64::from(size.y);
        let needed = pixels * (BYTES_PER_PIXEL + tint) + trace_bytes(trace, size);
        let too_large = || {
            let what = format!("a picture of {}x{}", size.x, size.y);
            gpu.out_of_memory(what, Some(needed), "ask for a smaller picture")
        };
        // Software drivers overcommit memory, and the system then kills the process.
        if gpu.is_software() && available_memory().is_some_and(|available| needed > available) {
            return Err(too_large());
        }
        let scope = gpu.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let targets = Self::create(gpu, shaders, gi, composite, size, trace, is_tinted);
        if scope.pop().await.is_some() {
            return Err(too_large());
        }
        targets
    }

    /// Discards earlier frames: the next frame is the first one of a picture.
    pub(crate) fn forget(&mut self) {
        self.view.forget();
        self.accumulate.forget();
        for beside in &mut self.beside {
            beside.forget();
        }
    }

    fn create(
        gpu: &Gpu,
        shaders: &ShaderLibrary,
        gi: &Gi,
        composite: &CompositePass,
        size: UVec2,
        trace: &TraceSettings,
        is_tinted: bool,
    ) -> Result<Self, RenderError> {
        let device = &gpu.pipelines;
        let mut textures = ScreenTextures::new(device, size);
        let wanted = [is_tinted, trace.temporal];
        let gbuffer_textures = GBufferTargets::new(gpu, &mut textures, wanted);
        let view = gi.view(gbuffer_textures.views(), size, trace);
        let direct = DirectPass::targets(&mut textures);
        let composite = composite.targets(device, &mut textures, &gbuffer_textures, &direct, &view);
        let voxel_view = VoxelViewPass::new(device, shaders, &composite);
        let frames = (&composite.picture, view.is_temporal().then_some(gi));
        let accumulate = AccumulatePass::new(device, shaders, &mut textures, size, frames)?;
        let tone_map = ToneMapPass::new(device, shaders, &mut textures, size)?;
        let bytes = textures.bytes + view.memory();
        Ok(Self {
            gbuffer_textures,
            direct,
            view,
            composite,
            voxel_view,
            accumulate,
            tone_map,
            beside: Vec::new(),
            overlay: None,
            bytes,
        })
    }
}
