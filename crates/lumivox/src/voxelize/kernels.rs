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

/// Two variants of a walk over items: for groups of draws that lack something (holes, textures), and for those
/// that have it.
#[derive(Debug)]
pub(super) struct Variants {
    without: Kernel,
    with: Kernel,
}

impl Variants {
    pub fn choose(&self, has_it: bool) -> &Kernel {
        if has_it { &self.with } else { &self.without }
    }
}

/// All kernels.
#[derive(Debug)]
pub(super) struct Kernels {
    pub layouts: Layouts,
    pub scan: Scan,
    pub indirect: Indirect,
    pub list: ListBuilder,
    pub split: Kernel,
    pub mark: Variants,
    pub lobes: Variants,
    pub accumulate: Variants,
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
        let variants = |module: &str, entries: [&str; 2], pass: &wgpu::BindGroupLayout| {
            let walk = |entry| kernel(module, entry, &[&layouts.triangles, pass, &layouts.run]);
            Ok::<_, ShaderError>(Variants { without: walk(entries[0])?, with: walk(entries[1])? })
        };
        let holes = ["opaque", "covered"];
        let textures = ["plain", "textured"];
        Ok(Self {
            scan: Scan::new(device, shaders)?,
            indirect: Indirect::new(device, shaders)?,
            list: ListBuilder::new(device, shaders, &layouts.grid)?,
            split: kernel("voxelize::split", "main", &[&layouts.triangles, &layouts.split])?,
            mark: variants("voxelize::mark", holes, &layouts.mark)?,
            lobes: variants("voxelize::lobes", holes, &layouts.lobes)?,
            accumulate: variants("voxelize::accumulate", textures, &layouts.accumulate)?,
            count_faces: kernel("voxelize::faces", "count", &[&layouts.faces])?,
            prepare_faces: kernel("voxelize::faces", "prepare", &[&layouts.faces])?,
            resolve: kernel("voxelize::resolve", "main", &[&layouts.resolve])?,
            layouts,
        })
    }
}
