//! Views of the voxels: the content of the volume, at any level.
//!
//! *Voxels*: cells as cubes; a cube's face shows the radiance of its cell through that face,
//! without the cell's opacity, and faint outlines separate cubes. *Lit*: the cells that light
//! reaches. For an octree also *nodes*, the boxes around the cells of a level, and *bricks*, their
//! texels including the neighbours' layer.
//!
//! *Wire voxels*: the cubes' outlines, found in the occupancy bits of the voxel list; the overlay's
//! wire cubes use the same walk. *Lod*: the volume's content at the visible surfaces. Each view is
//! linked when it is first shown.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use bytemuck::{Pod, Zeroable};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, TextureView, uniform_buffer,
};
use lumivox::{Gi, GiView, Lights, VolumeKind};

use crate::View;
use crate::passes::composite::{CompositeTargets, PICTURE_FORMAT};

/// `VoxelViewSettings` of `view.wgsl`.
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
    shaders: ShaderLibrary,
    /// The kernels of the views shown so far.
    kernels: HashMap<View, Kernel>,
    wires_layout: wgpu::BindGroupLayout,
    layout: wgpu::BindGroupLayout,
    settings: Buffer,
    group: BindGroup,
    picture: TextureView,
}

impl VoxelViewPass {
    /// Creates the bind group; the pass writes into `targets` in place of the composite.
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary, targets: &CompositeTargets) -> Self {
        let base = LayoutBuilder::compute()
            .uniform()
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT);
        let layout = base.clone().build(device, "voxel view");
        let wires_layout = base.storage().build(device, "wire voxels");
        let settings = uniform_buffer(device, "voxel view", &VoxelViewSettings::zeroed());
        let group = BindGroupBuilder::new(&layout)
            .buffer(&settings)
            .view(&targets.picture)
            .build(device, "voxel view");
        let (kernels, picture) = (HashMap::new(), targets.picture.clone());
        let shaders = shaders.clone();
        Self { shaders, kernels, wires_layout, layout, settings, group, picture }
    }

    /// Draws a level for a camera with the given vertical field of view. Level and field of view
    /// take effect at the next submission, so record one frame per recorder. A view that is not of
    /// voxels, or that the volume cannot show, is drawn as [`View::Voxels`]. [`View::Lod`] needs
    /// the G-buffer of this frame.
    ///
    /// # Errors
    /// When a shader does not link.
    pub fn record(
        &mut self,
        recorder: &mut Recorder,
        gi: &Gi,
        lights: &Lights,
        gbuffer: &GiView,
        (view, level): (View, u32),
        vertical_fov_rad: f32,
    ) -> Result<(), ShaderError> {
        let view = shown(view, gi);
        let kernel = self.prepare(gi, view)?.clone();
        let pixel_slope = 2.0 * (0.5 * vertical_fov_rad).tan() / gbuffer.size().y as f32;
        let settings = VoxelViewSettings { level, pixel_slope, padding: [0; 2] };
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        let wired = gi.voxels().filter(|_| view == View::WireVoxels);
        let own = wired.map(|voxels| {
            BindGroupBuilder::new(&self.wires_layout)
                .buffer(&self.settings)
                .view(&self.picture)
                .buffer(&voxels.occupancy)
                .build(recorder.device(), "wire voxels")
        });
        let own = own.as_ref().unwrap_or(&self.group);
        let groups = [gi.cell_globals(), own, &lights.group, gbuffer.group()];
        kernel.run(recorder, &groups, [gbuffer.size().x, gbuffer.size().y, 1]);
        Ok(())
    }

    /// The kernel of a view, linked at its first use.
    ///
    /// # Errors
    /// When its shader does not link.
    pub(crate) fn prepare(&mut self, gi: &Gi, view: View) -> Result<&Kernel, ShaderError> {
        let view = shown(view, gi);
        let slot = match self.kernels.entry(view) {
            Entry::Occupied(slot) => return Ok(slot.into_mut()),
            Entry::Vacant(slot) => slot,
        };
        let (name, entry, own) = match view {
            View::Lit => ("cubes", "lit", &self.layout),
            View::Nodes => ("nodes", "main", &self.layout),
            View::Bricks => ("bricks", "main", &self.layout),
            View::Lod => ("lod", "main", &self.layout),
            View::WireVoxels => ("wires", "main", &self.wires_layout),
            _ => ("cubes", "main", &self.layout),
        };
        let groups = [gi.cell_globals_layout(), own, gi.lights_layout(), gi.gbuffer_layout()];
        let module = format!("render::passes::voxel_view::{name}");
        Ok(slot.insert(Kernel::new(gi.pipelines(), &self.shaders, &module, entry, &groups)?))
    }
}

/// The view to draw instead if `view` is not of voxels, or its data does not exist.
fn shown(view: View, gi: &Gi) -> View {
    let is_octree = matches!(gi.config().volume, VolumeKind::Octree);
    match view {
        View::Lit | View::Lod => view,
        View::Nodes | View::Bricks if is_octree => view,
        View::WireVoxels if gi.voxels().is_some() => view,
        _ => View::Voxels,
    }
}
