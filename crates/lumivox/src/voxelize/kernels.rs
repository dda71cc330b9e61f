//! The kernels of the voxelizer and the layouts of their bind groups.

use crate::gpu::{Indirect, Kernel, LayoutBuilder, Scan, ShaderError, ShaderLibrary};
use crate::voxels::ListBuilder;

/// Layouts of bind groups. Group 0 is the grid, group 1 a batch's triangles, group 2 what a pass reads and
/// writes, group 3 the run of items and its textures. The passes over voxels have their own group 1.
#[derive(Debug)]
pub(super) struct Layouts {
    pub grid: wgpu::BindGroupLayout,
    pub triangles: wgpu::BindGroupLayout,
    pub split: wgpu::BindGroupLayout,
    pub mark: wgpu::BindGroupLayout,
    pub lobes: wgpu::BindGroupLayout,
    pub accumulate: wgpu::BindGroupLayout,
    pub run: wgpu::BindGroupLayout,
    pub faces: wgpu::BindGroupLayout,
    pub resolve: wgpu::BindGroupLayout,
}

impl Layouts {
    fn new(device: &wgpu::Device) -> Self {
        let compute = LayoutBuilder::compute;
        let triangles = compute().storage().storage().storage().storage();
        let split = compute().uniform().storage_mut().storage_mut();
        let lobes = compute().storage().storage().storage_mut().storage_mut();
        let accumulate = compute().storage().storage().storage().storage_mut();
        let run = compute().uniform().texture_2d().texture_2d().sampler();
        let resolve = compute().uniform().storage().storage_mut().storage_mut();
        Self {
            grid: compute().uniform().build(device, "grid"),
            triangles: triangles.build(device, "voxelize::triangles"),
            split: split.build(device, "voxelize::split"),
            mark: compute().storage().storage_mut().build(device, "voxelize::mark"),
            lobes: lobes.build(device, "voxelize::lobes"),
            accumulate: accumulate.build(device, "voxelize::accumulate"),
            run: run.build(device, "voxelize::run"),
            faces: compute().storage_mut().storage_mut().build(device, "voxelize::faces"),
            resolve: resolve.build(device, "voxelize::resolve"),
        }
    }
}

/// A walk over items, for surfaces without and with holes.
#[derive(Debug)]
pub(super) struct WalkKernels {
    pub opaque: Kernel,
    pub covered: Kernel,
}

/// All kernels.
#[derive(Debug)]
pub(super) struct Kernels {
    pub layouts: Layouts,
    pub scan: Scan,
    pub indirect: Indirect,
    pub list: ListBuilder,
    pub split: Kernel,
    pub mark: WalkKernels,
    pub lobes: WalkKernels,
    pub accumulate: Kernel,
    pub count_faces: Kernel,
    pub prepare_faces: Kernel,
    pub resolve: Kernel,
}

impl Kernels {
    pub fn new(device: &wgpu::Device, shaders: &ShaderLibrary) -> Result<Self, ShaderError> {
        let layouts = Layouts::new(device);
        let kernel = |module: &str, entry: &str, own: &[&wgpu::BindGroupLayout]| {
            let mut groups = vec![&layouts.grid];
            groups.extend(own);
            Kernel::new(device, shaders, module, entry, &groups)
        };
        let walk = |module: &str, entry: &str, pass: &wgpu::BindGroupLayout| {
            kernel(module, entry, &[&layouts.triangles, pass, &layouts.run])
        };
        let walks = |module: &str, pass: &wgpu::BindGroupLayout| {
            Ok::<_, ShaderError>(WalkKernels {
                opaque: walk(module, "opaque", pass)?,
                covered: walk(module, "covered", pass)?,
            })
        };
        Ok(Self {
            scan: Scan::new(device, shaders)?,
            indirect: Indirect::new(device, shaders)?,
            list: ListBuilder::new(device, shaders, &layouts.grid)?,
            split: kernel("voxelize::split", "main", &[&layouts.triangles, &layouts.split])?,
            mark: walks("voxelize::mark", &layouts.mark)?,
            lobes: walks("voxelize::lobes", &layouts.lobes)?,
            accumulate: walk("voxelize::accumulate", "main", &layouts.accumulate)?,
            count_faces: kernel("voxelize::faces", "count", &[&layouts.faces])?,
            prepare_faces: kernel("voxelize::faces", "prepare", &[&layouts.faces])?,
            resolve: kernel("voxelize::resolve", "main", &[&layouts.resolve])?,
            layouts,
        })
    }
}
