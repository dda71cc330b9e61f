//! Views of the voxels: what the cones see, at any level.
//!
//! *Voxels*: cells as cubes; a cube's face shows the radiance of its cell as seen straight through that face,
//! without the cell's opacity, and faint outlines tell cubes apart. *Lit*: which of them the lights reach. Of an
//! octree besides: *nodes*, the boxes that hold the cells of a level, and *bricks*, their texels with the layer that
//! they have from their neighbours.

use bytemuck::{Pod, Zeroable};
use lumivox::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Recorder, ShaderError, ShaderLibrary, uniform_buffer,
};
use lumivox::{GBuffer, Gi, Lights, VolumeKind};

use crate::View;
use crate::composite::{CompositeTargets, PICTURE_FORMAT};

/// The shader modules of this folder by their paths below `render`.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("voxel_view::bricks", include_str!("bricks.wgsl")),
    ("voxel_view::cell_walk", include_str!("cell_walk.wgsl")),
    ("voxel_view::cubes", include_str!("cubes.wgsl")),
    ("voxel_view::first_cube", include_str!("first_cube.wgsl")),
    ("voxel_view::nodes", include_str!("nodes.wgsl")),
    ("voxel_view::view", include_str!("view.wgsl")),
];

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
    cubes: Kernel,
    lit: Kernel,
    octree: Option<OctreeKernels>,
    settings: wgpu::Buffer,
    group: wgpu::BindGroup,
}

/// What only an octree can show.
#[derive(Debug)]
struct OctreeKernels {
    nodes: Kernel,
    bricks: Kernel,
}

impl VoxelViewPass {
    /// Makes the pipelines; it writes into `targets` instead of the composite.
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
        let kernel = |module: &str, entry: &str| {
            let module = format!("render::voxel_view::{module}");
            Kernel::new(device, shaders, &module, entry, &groups)
        };
        let octree = match gi.config().volume {
            VolumeKind::Dense => None,
            VolumeKind::Octree(_) => Some(OctreeKernels {
                nodes: kernel("nodes", "main")?,
                bricks: kernel("bricks", "main")?,
            }),
        };
        let settings = uniform_buffer(device, "voxel view", &VoxelViewSettings::zeroed());
        let group = BindGroupBuilder::new(&layout)
            .buffer(&settings)
            .view(&targets.picture)
            .build(device, "voxel view");
        let (cubes, lit) = (kernel("cubes", "main")?, kernel("cubes", "lit")?);
        Ok(Self { cubes, lit, octree, settings, group })
    }

    /// Shows a level to a camera of the given vertical field of view. Both take effect at the next
    /// submission: one frame per recorder. A view that is not one of the voxels, or that the volume cannot show, is
    /// shown as [`View::Voxels`].
    pub fn record(
        &self,
        recorder: &mut Recorder,
        gi: &Gi,
        lights: &Lights,
        gbuffer: &GBuffer,
        (view, level): (View, u32),
        vertical_fov_rad: f32,
    ) {
        let pixel_slope = 2.0 * (0.5 * vertical_fov_rad).tan() / gbuffer.size.y as f32;
        let settings = VoxelViewSettings { level, pixel_slope, padding: [0; 2] };
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        let groups = [gi.globals(), &self.group, &lights.group, &gbuffer.group];
        let kernel = match (view, &self.octree) {
            (View::Lit, _) => &self.lit,
            (View::Nodes, Some(octree)) => &octree.nodes,
            (View::Bricks, Some(octree)) => &octree.bricks,
            _ => &self.cubes,
        };
        kernel.run(recorder, &groups, [gbuffer.size.x, gbuffer.size.y, 1]);
    }
}
