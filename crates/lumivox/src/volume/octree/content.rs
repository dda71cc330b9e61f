//! Content of the octree: the values of cells, and the bricks filled from values.

use super::tree::Tree;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
};
use crate::volume::CELL_FORMAT;
use crate::volume::changes::{ChangedCells, LevelWords};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

/// The kernels that fill the octree.
#[derive(Debug)]
pub(super) struct ContentKernels {
    store_layout: wgpu::BindGroupLayout,
    filter_layout: wgpu::BindGroupLayout,
    fill_layout: wgpu::BindGroupLayout,
    store: Kernel,
    filter: Kernel,
    fill: Kernel,
    /// [`LevelWords`] of each level.
    levels: Vec<Buffer>,
}

/// A list with its light, an octree, and the changed cells, bound together.
#[derive(Debug)]
pub(super) struct BoundContent {
    /// Group 0.
    globals: BindGroup,
    store: BindGroup,
    /// Bind groups for filtering each level except the finest.
    filters: Vec<BindGroup>,
    /// Bind groups for filling the bricks of each level's cells.
    fills: Vec<BindGroup>,
}

impl ContentKernels {
    pub fn new(device: &Pipelines, shaders: &ShaderLibrary, grid: &Grid) -> Result<Self, GiError> {
        let search = LayoutBuilder::compute()
            .uniform()
            .uniform()
            .storage()
            .build(device, "volume::octree::search");
        // Changed cells, nodes, values, `Needs`.
        let cells = || {
            let layout = LayoutBuilder::compute().uniform().storage().storage().storage();
            layout.storage_mut().uniform()
        };
        let store_layout =
            cells().storage().storage().storage().build(device, "volume::octree::store");
        let filter_layout = cells().build(device, "volume::octree::filter");
        let fill_layout = cells()
            .storage_texture(wgpu::TextureViewDimension::D3, CELL_FORMAT)
            .build(device, "volume::octree::fill");
        let kernel = |module: &str, layout: &wgpu::BindGroupLayout| {
            Kernel::new(device, shaders, module, "main", &[&search, layout])
        };
        Ok(Self {
            store: kernel("volume::octree::store", &store_layout)?,
            filter: kernel("volume::octree::filter", &filter_layout)?,
            fill: kernel("volume::octree::fill", &fill_layout)?,
            levels: LevelWords::of_levels(device, grid),
            store_layout,
            filter_layout,
            fill_layout,
        })
    }

    /// Binds an octree to its list, its light, and the cells that will change; `globals` is group
    /// 0.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        (grid, globals): (&Grid, BindGroup),
        (voxels, radiance): (&VoxelList, &Buffer),
        changed: &ChangedCells,
        (tree, needs): (&Tree, &Buffer),
    ) -> BoundContent {
        let of_level = |layout, level: usize| {
            BindGroupBuilder::new(layout)
                .buffer(&self.levels[level])
                .buffer(&changed.ranks)
                .buffer(&changed.cells)
                .buffer(&voxels.nodes)
                .buffer(&tree.values)
                .buffer(needs)
        };
        let store = of_level(&self.store_layout, 0)
            .buffer(&voxels.first_faces)
            .buffer(&voxels.faces)
            .buffer(radiance)
            .build(device, "volume::octree::store");
        let filters = (1..grid.levels)
            .map(|level| {
                of_level(&self.filter_layout, level as usize)
                    .build(device, "volume::octree::filter")
            })
            .collect();
        let fills = (0..grid.levels)
            .map(|level| {
                of_level(&self.fill_layout, level as usize)
                    .view(&tree.atlas)
                    .build(device, "volume::octree::fill")
            })
            .collect();
        BoundContent { globals, store, filters, fills }
    }

    /// Stores the changed radiance of the faces, filters it, and fills the bricks.
    pub fn update(&self, recorder: &mut Recorder, bound: &BoundContent, changed: &ChangedCells) {
        let globals = &bound.globals;
        recorder.compute("volume::octree::store", |pass| {
            changed.dispatch(pass, &self.store, &[globals, &bound.store], 0);
        });
        recorder.compute("volume::octree::filter", |pass| {
            for (finer, group) in bound.filters.iter().enumerate() {
                changed.dispatch(pass, &self.filter, &[globals, group], finer + 1);
            }
        });
        recorder.compute("volume::octree::fill", |pass| {
            for (level, group) in bound.fills.iter().enumerate() {
                changed.dispatch(pass, &self.fill, &[globals, group], level);
            }
        });
    }
}
