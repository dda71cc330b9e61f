//! Wire cubes of one level.

use bytemuck::{Pod, Zeroable};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, TextureView, uniform_buffer,
};
use lumivox::{Gi, GiView};

use super::segment::FRAME_FORMAT;
use super::{Overlay, WIRE_VOXEL_COLOR, Wires};

/// `WireSettings` of `voxels.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct WireSettings {
    pub(crate) color: [f32; 4],
    pub(crate) background: [f32; 4],
    pub(crate) level: u32,
    pub(crate) is_hidden_by_surfaces: u32,
    padding: [u32; 2],
}

/// Draws the wire cubes of one level.
#[derive(Debug)]
pub(super) struct WireVoxels {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    settings: Buffer,
    /// Bound as group 2: wires need no light.
    nothing: BindGroup,
}

impl WireVoxels {
    /// # Errors
    /// When the shader does not link.
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        gi: &Gi,
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage_texture(wgpu::TextureViewDimension::D2, FRAME_FORMAT)
            .storage()
            .build(device, "wire voxels");
        let nothing = LayoutBuilder::compute().build(device, "nothing");
        let groups = [gi.cell_globals_layout(), &layout, &nothing, gi.gbuffer_layout()];
        let kernel =
            Kernel::new(device, shaders, "render::passes::overlay::voxels", "main", &groups)?;
        let settings = uniform_buffer(device, "wire voxels", &WireSettings::zeroed());
        let nothing = BindGroupBuilder::new(&nothing).build(device, "nothing");
        Ok(Self { kernel, layout, settings, nothing })
    }

    /// Starts a frame of the overlay with the cubes of a level; once per submission.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder,
        (gi, view): (&Gi, &GiView),
        (overlay, level): (&Overlay, u32),
        background: [f32; 4],
        frame: &TextureView,
    ) {
        // Occupancy only exists once there is a voxel list.
        let Some(voxels) = gi.voxels() else { return };
        let settings = WireSettings {
            color: WIRE_VOXEL_COLOR,
            background,
            level,
            is_hidden_by_surfaces: u32::from(overlay.wire_voxels == Wires::Over),
            padding: [0; 2],
        };
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&self.settings)
            .view(frame)
            .buffer(&voxels.occupancy)
            .build(recorder.device(), "wire voxels");
        let groups = [gi.cell_globals(), &group, &self.nothing, view.group()];
        self.kernel.run(recorder, &groups, [view.size().x, view.size().y, 1]);
    }
}
