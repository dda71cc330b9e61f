//! The voxels as cubes: what the cones see, at any level.
//!
//! A cube's face shows the radiance of its cell as seen straight through that face, without the
//! cell's opacity; faint outlines tell cubes apart.

use bytemuck::{Pod, Zeroable};
use lumivox::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Recorder, ShaderError, ShaderLibrary, uniform_buffer,
};
use lumivox::{GBuffer, Gi, Lights};

use crate::composite::{CompositeTargets, PICTURE_FORMAT};

/// `VoxelViewSettings` of `voxel_view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct VoxelViewSettings {
    pub(crate) level: u32,
    pub(crate) pixel_slope: f32,
    padding: [u32; 2],
}

/// Shows the voxels.
#[derive(Debug)]
pub struct VoxelViewPass {
    kernel: Kernel,
    settings: wgpu::Buffer,
    group: wgpu::BindGroup,
}

impl VoxelViewPass {
    /// Makes the pipeline; it writes into `targets` instead of the composite.
    ///
    /// # Errors
    /// When the shader does not link.
    pub fn new(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        gi: &Gi,
        targets: &CompositeTargets,
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT)
            .build(device, "voxel view");
        let groups = [gi.globals_layout(), &layout, gi.lights_layout(), gi.gbuffer_layout()];
        let kernel = Kernel::new(device, shaders, "render::voxel_view", "main", &groups)?;
        let settings = uniform_buffer(device, "voxel view", &VoxelViewSettings::zeroed());
        let group = BindGroupBuilder::new(&layout)
            .buffer(&settings)
            .view(&targets.picture)
            .build(device, "voxel view");
        Ok(Self { kernel, settings, group })
    }

    /// Shows a level to a camera of the given vertical field of view. Both take effect at the next
    /// submission: one frame per recorder.
    pub fn record(
        &self,
        recorder: &mut Recorder,
        gi: &Gi,
        lights: &Lights,
        gbuffer: &GBuffer,
        level: u32,
        vertical_fov_rad: f32,
    ) {
        let pixel_slope = 2.0 * (0.5 * vertical_fov_rad).tan() / gbuffer.size.y as f32;
        let settings = VoxelViewSettings { level, pixel_slope, padding: [0; 2] };
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        let groups = [gi.globals(), &self.group, &lights.group, &gbuffer.group];
        self.kernel.run(recorder, &groups, [gbuffer.size.x, gbuffer.size.y, 1]);
    }
}
