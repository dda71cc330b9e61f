//! The kernels of the voxelizer and the layouts of their bind groups.

use std::collections::HashSet;

use super::hook::{Detail, Voxelization};
use crate::gpu::{Indirect, Kernel, LayoutBuilder, Pipelines, Scan, ShaderError, ShaderLibrary};
use crate::voxels::ListBuilder;

/// Layouts of bind groups. Group 0 is the grid, group 1 a batch's triangles, group 2 a pass's
/// inputs and outputs, group 3 the run of items and its textures. The passes over voxels have their
/// own group 1.
#[derive(Debug)]
pub(super) struct Layouts {
    pub grid: wgpu::BindGroupLayout,
    pub triangles: wgpu::BindGroupLayout,
    pub split: wgpu::BindGroupLayout,
    pub mark: wgpu::BindGroupLayout,
    pub planes: wgpu::BindGroupLayout,
    pub accumulate: wgpu::BindGroupLayout,
    pub run: wgpu::BindGroupLayout,
    pub faces: wgpu::BindGroupLayout,
    pub resolve: wgpu::BindGroupLayout,
    pub keep_bits: wgpu::BindGroupLayout,
    pub keep: wgpu::BindGroupLayout,
    pub merge_bits: wgpu::BindGroupLayout,
    pub renew: wgpu::BindGroupLayout,
    pub unite: wgpu::BindGroupLayout,
    pub needs: wgpu::BindGroupLayout,
    pub resolve_shares: wgpu::BindGroupLayout,
    pub starts: wgpu::BindGroupLayout,
    pub former: wgpu::BindGroupLayout,
    pub compare: wgpu::BindGroupLayout,
    pub commit_cells: wgpu::BindGroupLayout,
    pub commit_faces: wgpu::BindGroupLayout,
    pub describe: wgpu::BindGroupLayout,
}

impl Layouts {
    fn new(device: &Pipelines, voxelization: Option<&dyn Voxelization>) -> Self {
        use wgpu::ShaderStages;
        let compute = LayoutBuilder::compute;
        // The exact walk uses only compute.
        let drawn = voxelization.map_or(ShaderStages::NONE, Voxelization::stages);
        let written = drawn & ShaderStages::FRAGMENT;
        let walk = || LayoutBuilder::new(ShaderStages::COMPUTE | drawn);
        let pass = || LayoutBuilder::new(ShaderStages::COMPUTE | written);
        let triangles = walk().storage().storage().storage().storage();
        let split = compute().uniform().storage_mut().storage_mut();
        let planes = pass().storage().storage().storage_mut().storage_mut();
        let accumulate = pass().storage().storage().storage().storage_mut().uniform();
        let run = (0..3).fold(walk().uniform(), |run, _| run.texture_2d().sampler());
        // A pass over voxels: uniforms, read-only buffers, and written buffers.
        let voxels = |uniforms: u32, read: u32, written: u32, label: &str| {
            let layout = (0..uniforms).fold(compute(), |layout, _| layout.uniform());
            let layout = (0..read).fold(layout, |layout, _| layout.storage());
            (0..written).fold(layout, |layout, _| layout.storage_mut()).build(device, label)
        };
        let keep = (0..4).fold(compute(), |layout, _| layout.storage());
        let keep = keep.storage_mut().storage().storage_mut();
        let faces = compute().storage_mut().storage_mut().storage();
        Self {
            grid: walk().uniform().build(device, "grid"),
            triangles: triangles.build(device, "voxelize::triangles"),
            split: split.build(device, "voxelize::split"),
            mark: pass().storage().storage_mut().build(device, "voxelize::mark"),
            planes: planes.build(device, "voxelize::planes"),
            accumulate: accumulate.build(device, "voxelize::accumulate"),
            run: run.build(device, "voxelize::run"),
            faces: faces.build(device, "voxelize::faces"),
            resolve: voxels(1, 2, 2, "voxelize::resolve"),
            keep_bits: voxels(0, 1, 1, "voxelize::keep_bits"),
            keep: keep.build(device, "voxelize::keep"),
            merge_bits: voxels(0, 2, 1, "voxelize::merge_bits"),
            renew: voxels(0, 1, 1, "voxelize::renew"),
            unite: voxels(0, 5, 2, "voxelize::unite"),
            needs: voxels(1, 4, 2, "voxelize::needs"),
            resolve_shares: voxels(2, 4, 2, "voxelize::resolve_shares"),
            starts: voxels(1, 2, 1, "voxelize::starts"),
            former: voxels(1, 4, 1, "voxelize::former"),
            compare: voxels(1, 5, 1, "voxelize::compare"),
            commit_cells: voxels(1, 3, 4, "voxelize::commit_cells"),
            commit_faces: voxels(2, 1, 1, "voxelize::commit_faces"),
            describe: voxels(3, 6, 2, "voxelize::describe"),
        }
    }
}

/// The kernels of a walk over items, one for each [`Detail`].
#[derive(Debug)]
pub(super) struct Variants([Kernel; 3]);

impl Variants {
    pub fn choose(&self, detail: Detail) -> &Kernel {
        &self.0[detail as usize]
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
    pub planes: Variants,
    pub more_planes: Variants,
    pub accumulate: Variants,
    pub count_faces: Kernel,
    pub prepare_faces: Kernel,
    pub resolve: Kernel,
    pub keep_bits: Kernel,
    pub keep_lobes: Kernel,
    pub keep_faces: Kernel,
    pub merge_bits: Kernel,
    pub unite: Kernel,
    pub needs: Kernel,
    pub resolve_shares: Kernel,
    pub starts: Kernel,
    pub former: Kernel,
    pub compare: Kernel,
    pub commit_cells: Kernel,
    pub commit_faces: Kernel,
    pub describe: Kernel,
    pub renew: Kernel,
}

impl Kernels {
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        voxelization: Option<&dyn Voxelization>,
    ) -> Result<Self, ShaderError> {
        let layouts = Layouts::new(device, voxelization);
        let kernel = |module: &str, entry: &str, own: &[&wgpu::BindGroupLayout]| {
            let mut groups = vec![&layouts.grid];
            groups.extend(own);
            Kernel::new(device, shaders, module, entry, &groups)
        };
        let walk = |module: &str, entry: &str, pass: &wgpu::BindGroupLayout| {
            kernel(module, entry, &[&layouts.triangles, pass, &layouts.run])
        };
        // Compiled by `Self::make` once a scene needs it.
        let deferred = |module: &str, entry: &str, pass: &wgpu::BindGroupLayout| {
            let groups = [&layouts.grid, &layouts.triangles, pass, &layouts.run];
            Kernel::deferred(device, shaders, module, entry, &groups)
        };
        // If the surface's appearance does not matter, all details except pierced share a kernel.
        let by_holes = |module: &str, again: &str, pass: &wgpu::BindGroupLayout| {
            let opaque = walk(module, &format!("opaque{again}"), pass)?;
            let covered = deferred(module, &format!("covered{again}"), pass)?;
            Ok::<_, ShaderError>(Variants([opaque.clone(), opaque, covered]))
        };
        let (module, pass) = ("voxelize::accumulate", &layouts.accumulate);
        let by_detail = Variants([
            walk(module, "plain", pass)?,
            deferred(module, "varied", pass)?,
            deferred(module, "pierced", pass)?,
        ]);
        Ok(Self {
            scan: Scan::new(device, shaders)?,
            indirect: Indirect::new(device, shaders)?,
            list: ListBuilder::new(device, shaders, &layouts.grid)?,
            split: kernel("voxelize::split", "main", &[&layouts.triangles, &layouts.split])?,
            mark: by_holes("voxelize::mark", "", &layouts.mark)?,
            planes: by_holes("voxelize::planes", "", &layouts.planes)?,
            more_planes: by_holes("voxelize::planes", "_again", &layouts.planes)?,
            accumulate: by_detail,
            count_faces: kernel("voxelize::faces", "count", &[&layouts.faces])?,
            prepare_faces: kernel("voxelize::faces", "prepare", &[&layouts.faces])?,
            resolve: kernel("voxelize::resolve", "main", &[&layouts.resolve])?,
            keep_bits: kernel("voxelize::keep_bits", "main", &[&layouts.keep_bits])?,
            keep_lobes: kernel("voxelize::keep", "lobes", &[&layouts.keep])?,
            keep_faces: kernel("voxelize::keep", "faces", &[&layouts.keep])?,
            merge_bits: kernel("voxelize::merge_bits", "main", &[&layouts.merge_bits])?,
            unite: kernel("voxelize::unite", "main", &[&layouts.unite])?,
            needs: kernel("voxelize::needs", "main", &[&layouts.needs])?,
            resolve_shares: kernel("voxelize::resolve_shares", "main", &[&layouts.resolve_shares])?,
            starts: kernel("voxelize::starts", "main", &[&layouts.starts])?,
            former: kernel("voxelize::former", "main", &[&layouts.former])?,
            compare: kernel("voxelize::compare", "main", &[&layouts.compare])?,
            commit_cells: kernel("voxelize::commit_cells", "cells", &[&layouts.commit_cells])?,
            commit_faces: kernel("voxelize::commit_faces", "main", &[&layouts.commit_faces])?,
            describe: kernel("voxelize::describe", "main", &[&layouts.describe])?,
            renew: kernel("voxelize::renew", "main", &[&layouts.renew])?,
            layouts,
        })
    }

    /// Compiles the walks over runs of some details, all at once.
    pub async fn make(&self, details: impl Iterator<Item = Detail>) {
        let walks = [&self.mark, &self.planes, &self.more_planes, &self.accumulate];
        let details: HashSet<_> = details.collect();
        let chosen = |detail: &Detail| walks.map(|walk| walk.choose(*detail));
        Kernel::make_all(details.iter().flat_map(chosen)).await;
    }
}
