//! Stores faces into the dense volume, filters its pyramid, and clears the cells of an earlier
//! list; only changed cells are written.

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    TextureView,
};
use crate::volume::changes::{ChangedCells, LevelWords};
use crate::{GiError, Grid};

use crate::volume::{CELL_FORMAT, Directionality};
use crate::voxels::VoxelList;

/// Kernels, and the bind groups of the current voxel list.
#[derive(Debug)]
pub(super) struct Build {
    clear_layout: wgpu::BindGroupLayout,
    store_layout: wgpu::BindGroupLayout,
    filter_layout: wgpu::BindGroupLayout,
    clear: Kernel,
    store: Kernel,
    filter: Kernel,
    /// [`LevelWords`] of each level.
    levels: Vec<Buffer>,
    /// Bind group for storing into the finest level.
    store_group: Option<BindGroup>,
    /// Bind groups for filtering into each coarser level.
    filter_groups: Vec<BindGroup>,
    /// Bind groups for clearing each level.
    clear_groups: Vec<BindGroup>,
}

impl Build {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        directionality: Directionality,
        grid: &Grid,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let d3 = wgpu::TextureViewDimension::D3;
        let cells = LayoutBuilder::compute().uniform().storage().storage();
        let clear_layout =
            cells.clone().storage_texture(d3, CELL_FORMAT).build(device, "clear cells");
        let nodes = cells.storage();
        let store_layout = nodes
            .clone()
            .storage()
            .storage()
            .storage()
            .storage_texture(d3, CELL_FORMAT)
            .build(device, "store cells");
        let filter_layout =
            nodes.texture_3d().storage_texture(d3, CELL_FORMAT).build(device, "filter cells");
        let (clear, store, filter) = match directionality {
            Directionality::SixLobes => {
                ("six_lobes", "volume::dense::store", "volume::dense::filter")
            }
            Directionality::Isotropic => {
                ("isotropic", "volume::dense::isotropic_store", "volume::dense::isotropic_filter")
            }
        };
        let kernel =
            |module, entry, layout| Kernel::new(device, shaders, module, entry, &[globals, layout]);
        let levels = LevelWords::of_levels(device, grid);
        Ok(Self {
            clear: kernel("volume::dense::clear", clear, &clear_layout)?,
            store: kernel(store, "store", &store_layout)?,
            filter: kernel(filter, "main", &filter_layout)?,
            clear_layout,
            store_layout,
            filter_layout,
            levels,
            store_group: None,
            filter_groups: Vec::new(),
            clear_groups: Vec::new(),
        })
    }

    /// Creates the bind groups for a voxel list, its light and its changed cells; `views` are the
    /// levels of the texture.
    pub(super) fn bind(
        &mut self,
        device: &wgpu::Device,
        (voxels, radiance): (&VoxelList, &Buffer),
        [changed, wrong]: [&ChangedCells; 2],
        views: &[TextureView],
    ) {
        let store = BindGroupBuilder::new(&self.store_layout)
            .buffer(&self.levels[0])
            .buffer(&changed.ranks)
            .buffer(&changed.cells)
            .buffer(&voxels.nodes)
            .buffer(&voxels.first_faces)
            .buffer(&voxels.faces)
            .buffer(radiance)
            .view(&views[0])
            .build(device, "store cells");
        self.store_group = Some(store);
        self.filter_groups = (1..views.len())
            .map(|level| {
                BindGroupBuilder::new(&self.filter_layout)
                    .buffer(&self.levels[level])
                    .buffer(&changed.ranks)
                    .buffer(&changed.cells)
                    .buffer(&voxels.nodes)
                    .view(&views[level - 1])
                    .view(&views[level])
                    .build(device, "filter cells")
            })
            .collect();
        self.clear_groups = self
            .levels
            .iter()
            .zip(views)
            .map(|(level, view)| {
                BindGroupBuilder::new(&self.clear_layout)
                    .buffer(level)
                    .buffer(&wrong.ranks)
                    .buffer(&wrong.cells)
                    .view(view)
                    .build(device, "clear cells")
            })
            .collect();
    }

    /// Writes zeros to the cells with changed surface of all levels.
    pub(super) fn clear(
        &self,
        recorder: &mut Recorder<'_>,
        grid: &BindGroup,
        wrong: &ChangedCells,
    ) {
        recorder.compute("volume::dense::clear", |pass| {
            for (level, group) in self.clear_groups.iter().enumerate() {
                wrong.dispatch(pass, &self.clear, &[grid, group], level);
            }
        });
    }

    /// Writes the faces' radiance into the finest level and filters it into the coarser ones.
    pub(super) fn update(&self, recorder: &mut Recorder, grid: &BindGroup, changed: &ChangedCells) {
        recorder.compute("volume::dense::store", |pass| {
            if let Some(group) = &self.store_group {
                changed.dispatch(pass, &self.store, &[grid, group], 0);
            }
        });
        recorder.compute("volume::dense::filter", |pass| {
            for (level, group) in self.filter_groups.iter().enumerate() {
                changed.dispatch(pass, &self.filter, &[grid, group], level + 1);
            }
        });
    }
}
