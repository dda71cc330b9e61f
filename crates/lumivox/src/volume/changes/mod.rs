//! Finds the cells of a volume whose content is outdated, so that only these are written.
//!
//! This depends only on the voxel list and the faces' radiance: any volume can use it. A bit per
//! cell, laid out like the list's occupancy bits, is set if the surface or light of the cell, or of
//! any finer cell in it, differs from the stored one. Cells with set bits are listed, and passes
//! that write to the volume run only over them. The values that they write depend only on the voxel
//! list and the radiance, so the volume is bit-identical to one with all cells written.
//!
//! Voxelization sets the bits of voxels with changed surface (`voxelize/union.rs`). Each face's
//! light is compared with the light that the volume stores ([`Changes::find`]).

mod list;
#[cfg(test)]
mod tests;

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
};
use crate::voxels::{
    BoundPyramid, LIST_COUNT_BYTES, Pyramid, VoxelList, level_arguments, level_block,
};
use crate::{GiError, Grid};
#[cfg(test)]
pub(crate) use list::ListParams;
use list::Lister;
pub(crate) use list::{ChangedCells, LevelWords};

/// Outgoing radiance of a list's faces, now and as stored by the volume (`array<vec4f>` both).
#[derive(Clone, Copy, Debug)]
pub(crate) struct Shown<'a> {
    pub(crate) now: &'a Buffer,
    pub(crate) held: &'a Buffer,
}

/// The data of the current voxel list.
#[derive(Debug)]
struct Bound {
    occupancy: Buffer,
    counts: Buffer,
    relit: BindGroup,
    /// Occupied cells to be written.
    changed: ChangedCells,
    /// All cells with changed surface, including removed ones.
    wrong: ChangedCells,
}

/// Finds the cells that have changed.
#[derive(Debug)]
pub(crate) struct Changes {
    grid: Grid,
    globals: BindGroup,
    pyramid: Pyramid,
    relit_layout: wgpu::BindGroupLayout,
    relit: Kernel,
    lister: Lister,
    bits: Buffer,
    levels: BoundPyramid,
    bound: Option<Bound>,
    /// `true` if the bits belong to a new list that the volume has not stored yet.
    is_list_new: bool,
    /// `true` if the cells of the bits have been stored.
    is_stored: bool,
    /// `true` if nothing is known about the volume's content.
    is_forgotten: bool,
}

impl Changes {
    /// Voxelizations set `bits`.
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        bits: &Buffer,
    ) -> Result<Self, GiError> {
        let uniform = grid.uniform(device);
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let globals = BindGroupBuilder::new(&grid_layout).buffer(&uniform).build(device, "grid");
        let relit_layout = (0..3)
            .fold(LayoutBuilder::compute().uniform(), |layout, _| layout.storage())
            .storage_mut()
            .storage_mut()
            .build(device, "relit voxels");
        let groups = [&grid_layout, &relit_layout];
        let pyramid = Pyramid::new(device, shaders, &grid_layout)?;
        Ok(Self {
            grid: *grid,
            levels: pyramid.bind(device, grid, bits),
            pyramid,
            lister: Lister::new(device, shaders, &grid_layout)?,
            relit: Kernel::new(device, shaders, "volume::changes::relit", "main", &groups)?,
            globals,
            relit_layout,
            bits: bits.clone(),
            bound: None,
            is_list_new: false,
            is_stored: false,
            is_forgotten: false,
        })
    }

    /// Call before a voxelization: clears the bits if their cells have been stored.
    pub(crate) fn begin(&mut self, recorder: &mut Recorder<'_>) {
        if std::mem::take(&mut self.is_stored) {
            recorder.clear(&self.bits);
        }
    }

    /// Binds another list, or the same one after its buffers were resized; cells of `old` may no
    /// longer exist.
    pub(crate) fn bind(
        &mut self,
        device: &wgpu::Device,
        old: Option<&VoxelList>,
        voxels: &VoxelList,
        shown: Shown<'_>,
    ) {
        let relit = BindGroupBuilder::new(&self.relit_layout)
            .slice(&voxels.counts, level_block(0), LIST_COUNT_BYTES)
            .buffer(&voxels.nodes)
            .buffer(&voxels.first_faces)
            .buffer(shown.now)
            .buffer(shown.held)
            .buffer(&self.bits)
            .build(device, "relit voxels");
        let nodes = voxels.node_capacity();
        let gone = old.map_or(nodes, VoxelList::node_capacity);
        let cells = |count, only_occupied| {
            let bits = (&self.bits, voxels);
            self.lister.cells(device, &self.grid, bits, count, only_occupied)
        };
        self.bound = Some(Bound {
            occupancy: voxels.occupancy.clone(),
            counts: voxels.counts.clone(),
            relit,
            changed: cells(nodes, true),
            wrong: cells(nodes + gone, false),
        });
    }

    /// Call after a voxelization: finds the cells with changed surface, including removed ones, and
    /// lists them if `lists_them`.
    pub(crate) fn wrong(&mut self, recorder: &mut Recorder<'_>, lists_them: bool) {
        recorder.stage("changes");
        self.is_list_new = true;
        let Some(bound) = &self.bound else { return };
        self.pyramid.run(recorder, &self.globals, &self.levels);
        if lists_them {
            self.lister.list(recorder, &self.globals, &bound.wrong);
        }
    }

    /// Call before surfaces are needed, regardless of their light: returns the cells that do not
    /// store the current list's surfaces; `None` if the volume is up to date.
    pub(crate) fn surfaces(&mut self, recorder: &mut Recorder<'_>) -> Option<&ChangedCells> {
        if self.is_list_new { self.list(recorder) } else { None }
    }

    /// Call before the current radiance is stored: returns the cells whose stored radiance differs.
    /// Afterwards `held` equals `now`.
    pub(crate) fn find(&mut self, recorder: &mut Recorder<'_>) -> Option<&ChangedCells> {
        let bound = self.bound.as_ref()?;
        if self.is_forgotten {
            recorder.copy((&bound.occupancy, 0), (&self.bits, 0), self.bits.size());
        } else if self.is_stored {
            recorder.clear(&self.bits);
        }
        recorder.compute("volume::changes::relit", |pass| {
            let groups = [&self.globals, &bound.relit];
            self.relit.dispatch_indirect(pass, &groups, &bound.counts, level_arguments(0));
        });
        self.pyramid.run(recorder, &self.globals, &self.levels);
        (self.is_list_new, self.is_forgotten, self.is_stored) = (false, false, true);
        self.list(recorder)
    }

    /// Lists the occupied cells whose bits are set.
    fn list(&self, recorder: &mut Recorder<'_>) -> Option<&ChangedCells> {
        let bound = self.bound.as_ref()?;
        self.lister.list(recorder, &self.globals, &bound.changed);
        Some(&bound.changed)
    }

    /// Discards the knowledge of the volume's content, so that the next update stores all cells.
    pub(crate) fn forget(&mut self) {
        self.is_forgotten = true;
    }

    /// The lists that are filled by [`Self::find`] and similar methods, and by [`Self::wrong`].
    pub(crate) fn cells(&self) -> Option<[&ChangedCells; 2]> {
        self.bound.as_ref().map(|bound| [&bound.changed, &bound.wrong])
    }

    /// A bit per cell, laid out like the list's occupancy: cells with changed surface after a
    /// voxelization, stored cells after a light update. `None` before the first list.
    pub(crate) fn bits(&self) -> Option<&Buffer> {
        self.bound.as_ref().map(|_| &self.bits)
    }

    /// Bytes on the GPU, by use.
    pub(crate) fn memory(&self) -> Vec<(&'static str, u64)> {
        let cells = self.cells().into_iter().flatten().map(ChangedCells::bytes).sum::<u64>();
        vec![("voxels: changed cells", self.bits.size() + cells)]
    }
}
