//! Storing faces into the dense volume, filtering its pyramid, and clearing what an earlier list had written.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Recorder, ShaderLibrary, uniform_buffer,
};
use crate::voxels::{VoxelList, level_first_word};
use crate::{GiError, Grid};

use super::{CELL_FORMAT, Directionality};

/// `NodeRange` of `level_range.wgsl`: the nodes of a level.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct NodeRange {
    pub(crate) level: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) first_mask_entry: u32,
    pub(crate) first_word: u32,
}

impl NodeRange {
    pub(super) fn new(voxels: &VoxelList, level: u32) -> Self {
        let nodes = voxels.level_nodes(level);
        let (first, count) = (nodes.start, nodes.len() as u32);
        Self { level, first, count, first_mask_entry: 0, first_word: 0 }
    }
}

/// What of the faces is stored, and where anything has changed.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaceBuffers<'a> {
    pub(super) radiance: &'a wgpu::Buffer,
    /// A bit per cell, laid out as the list's occupancy.
    pub(super) changed: &'a wgpu::Buffer,
}

/// A bind group with the number of nodes that it is for.
#[derive(Debug)]
struct Work {
    group: wgpu::BindGroup,
    count: u64,
}

/// Kernels, and the bind groups of the current voxel list.
#[derive(Debug)]
pub(super) struct Build {
    store_layout: wgpu::BindGroupLayout,
    filter_layout: wgpu::BindGroupLayout,
    store: Kernel,
    clear: Kernel,
    filter: Kernel,
    /// Writing to each level, the finest first; the store uses the first one.
    writes: Vec<Work>,
    /// Filtering into each level but the finest.
    filters: Vec<Work>,
}

impl Build {
    pub(super) fn new(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        directionality: Directionality,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let d3 = wgpu::TextureViewDimension::D3;
        let nodes = LayoutBuilder::compute().uniform().storage().storage();
        let store_layout = nodes
            .clone()
            .storage()
            .storage()
            .storage()
            .storage_texture(d3, CELL_FORMAT)
            .build(device, "store cells");
        let filter_layout =
            nodes.texture_3d().storage_texture(d3, CELL_FORMAT).build(device, "filter cells");
        let (store, filter) = match directionality {
            Directionality::SixLobes => ("volume::store", "volume::filter"),
            Directionality::Isotropic => ("volume::isotropic_store", "volume::isotropic_filter"),
        };
        let kernel =
            |module, entry, layout| Kernel::new(device, shaders, module, entry, &[globals, layout]);
        Ok(Self {
            store: kernel(store, "store", &store_layout)?,
            clear: kernel(store, "clear", &store_layout)?,
            filter: kernel(filter, "main", &filter_layout)?,
            store_layout,
            filter_layout,
            writes: Vec::new(),
            filters: Vec::new(),
        })
    }

    /// Makes the bind groups for a voxel list; `levels` are the views of the texture's levels.
    pub(super) fn bind(
        &mut self,
        device: &wgpu::Device,
        voxels: &VoxelList,
        FaceBuffers { radiance, changed }: FaceBuffers<'_>,
        (grid, levels): (&Grid, &[wgpu::TextureView]),
    ) {
        let range = |level: usize| {
            let first_word = level_first_word(grid, level as u32) as u32;
            let range = NodeRange { first_word, ..NodeRange::new(voxels, level as u32) };
            (uniform_buffer(device, "node range", &range), u64::from(range.count))
        };
        self.writes = (0..levels.len())
            .map(|level| {
                let (uniform, count) = range(level);
                let group = BindGroupBuilder::new(&self.store_layout)
                    .buffer(&uniform)
                    .buffer(&voxels.nodes)
                    .buffer(changed)
                    .buffer(&voxels.first_faces)
                    .buffer(&voxels.faces)
                    .buffer(radiance)
                    .view(&levels[level])
                    .build(device, "store cells");
                Work { group, count }
            })
            .collect();
        self.filters = (1..levels.len())
            .map(|level| {
                let (uniform, count) = range(level);
                let group = BindGroupBuilder::new(&self.filter_layout)
                    .buffer(&uniform)
                    .buffer(&voxels.nodes)
                    .buffer(changed)
                    .view(&levels[level - 1])
                    .view(&levels[level])
                    .build(device, "filter cells");
                Work { group, count }
            })
            .collect();
    }

    /// Writes zeros over what the current list has written, where anything has changed.
    pub(super) fn clear(&self, recorder: &mut Recorder, grid: &wgpu::BindGroup) {
        recorder.compute("volume::clear", |pass| {
            for work in &self.writes {
                self.clear.dispatch_linear(pass, &[grid, &work.group], work.count);
            }
        });
    }

    /// Writes the faces' radiance into the finest level and filters it into the coarser ones, where anything has
    /// changed.
    pub(super) fn update(&self, recorder: &mut Recorder, grid: &wgpu::BindGroup) {
        recorder.compute("volume::store", |pass| {
            if let Some(work) = self.writes.first() {
                self.store.dispatch_linear(pass, &[grid, &work.group], work.count);
            }
        });
        recorder.compute("volume::filter", |pass| {
            for work in &self.filters {
                self.filter.dispatch_linear(pass, &[grid, &work.group], work.count);
            }
        });
    }
}
