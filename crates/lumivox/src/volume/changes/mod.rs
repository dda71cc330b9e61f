//! The cells of a volume whose content is outdated, so that all others can stay as they are.
//!
//! It works only on the voxel list and the faces' radiance: any volume can use it. A bit per cell,
//! laid out as the list's occupancy bits, says whether the cell's surface or light, or that of any
//! cell below it, differs from what is stored. The cells whose bits are set are listed, and passes
//! that write to the volume run only over them. The values that they write depend only on the voxel
//! list and the radiance: so the volume has the same bits as if all cells were written.
//!
//! A new list is compared with the one before: voxels that are gone, new, or of another surface
//! have changed. Light is compared with the volume's content of each face, which is carried along
//! from list to list. With bounces nearly all light changes whenever something moves, and changes
//! several times within one update; there everything is written, and nothing is remembered. See
//! [`Changes::find`] and [`Changes::all`].

mod list;
#[cfg(test)]
mod tests;

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer, uniform_buffer,
};
use crate::voxels::{Pyramid, VoxelList, level_first_word};
use crate::{GiError, Grid};
#[cfg(test)]
pub(crate) use list::ListParams;
use list::{Bits, Lister};
pub(crate) use list::{ChangedCells, LevelWords};

/// The shader modules of this folder.
pub(super) const MODULES: &[(&str, &str)] = &[
    ("volume::changes::carry", include_str!("carry.wgsl")),
    ("volume::changes::cells", include_str!("cells.wgsl")),
    ("volume::changes::gone", include_str!("gone.wgsl")),
    ("volume::changes::list", include_str!("list.wgsl")),
    ("volume::changes::moved", include_str!("moved.wgsl")),
    ("volume::changes::relit", include_str!("relit.wgsl")),
];

/// `MovedParams` of `moved.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MovedParams {
    pub(crate) voxel_count: u32,
    pub(crate) finest_words: u32,
    pub(crate) all: u32,
}

/// The data of the current voxel list.
#[derive(Debug)]
struct Bound {
    params: Buffer,
    voxel_count: u64,
    occupancy: Buffer,
    ranks: Buffer,
    nodes: Buffer,
    first_faces: Buffer,
    radiance: Buffer,
    /// The radiance that the volume holds of each face (`array<vec4f>`), if that is known.
    held: Option<Buffer>,
    /// The occupied cells that are to be written.
    changed: ChangedCells,
}

impl Bound {
    fn bits<'a>(&'a self, changed: &'a Buffer) -> Bits<'a> {
        Bits { changed, occupancy: &self.occupancy, ranks: &self.ranks }
    }
}

/// Finds the cells that have changed.
#[derive(Debug)]
pub(crate) struct Changes {
    grid: Grid,
    globals: BindGroup,
    pyramid: Pyramid,
    gone_layout: wgpu::BindGroupLayout,
    moved_layout: wgpu::BindGroupLayout,
    carry_layout: wgpu::BindGroupLayout,
    relit_layout: wgpu::BindGroupLayout,
    gone: Kernel,
    moved: Kernel,
    carry: Kernel,
    relit: Kernel,
    lister: Lister,
    bits: Option<Buffer>,
    bound: Option<Bound>,
    /// The bits are those of a new list that the volume has not stored yet.
    is_list_new: bool,
}

impl Changes {
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
    ) -> Result<Self, GiError> {
        let uniform = grid.uniform(device);
        let grid_layout = LayoutBuilder::compute().uniform().build(device, "grid");
        let globals = BindGroupBuilder::new(&grid_layout).buffer(&uniform).build(device, "grid");
        let layout = |reads: u32, writes: u32, label: &str| {
            let reads = (0..reads).fold(LayoutBuilder::compute().uniform(), |l, _| l.storage());
            (0..writes).fold(reads, |layout, _| layout.storage_mut()).build(device, label)
        };
        let gone_layout = layout(2, 1, "gone voxels");
        let moved_layout = layout(7, 1, "moved voxels");
        let carry_layout = layout(7, 1, "carried light");
        let relit_layout = layout(3, 2, "relit voxels");
        let kernel = |module: &str, layout| {
            let module = format!("volume::changes::{module}");
            Kernel::new(device, shaders, &module, "main", &[&grid_layout, layout])
        };
        Ok(Self {
            grid: *grid,
            pyramid: Pyramid::new(device, shaders, &grid_layout)?,
            lister: Lister::new(device, shaders, &grid_layout)?,
            gone: kernel("gone", &gone_layout)?,
            moved: kernel("moved", &moved_layout)?,
            carry: kernel("carry", &carry_layout)?,
            relit: kernel("relit", &relit_layout)?,
            globals,
            gone_layout,
            moved_layout,
            carry_layout,
            relit_layout,
            bits: None,
            bound: None,
            is_list_new: false,
        })
    }

    /// Takes a new list, of which the bits become those of the cells whose surface is not what it
    /// was in the list before, cells that are gone included. These cells are returned, too, if
    /// asked for: the volume's content there is wrong. `radiance` is the light that the faces will
    /// send out.
    pub(crate) fn rebuild(
        &mut self,
        recorder: &mut Recorder,
        (old, voxels): (Option<&VoxelList>, &VoxelList),
        radiance: &Buffer,
        lists_wrong: bool,
    ) -> Option<ChangedCells> {
        recorder.stage("changes");
        let device = recorder.device().clone();
        let bytes = voxels.occupancy.size();
        let bits = self.bits.take().unwrap_or_else(|| storage_buffer(&device, "changed", bytes));
        // The volume holds nothing of a list that was never stored.
        let all = self.is_list_new;
        let params = MovedParams {
            voxel_count: voxels.voxel_count(),
            finest_words: level_first_word(&self.grid, 1) as u32,
            all: u32::from(all),
        };
        let nodes = |voxels: &VoxelList| voxels.level_starts.last().map_or(0, |&n| u64::from(n));
        let mut bound = Bound {
            params: uniform_buffer(&device, "changes parameters", &params),
            voxel_count: u64::from(params.voxel_count),
            occupancy: voxels.occupancy.clone(),
            ranks: voxels.ranks.clone(),
            nodes: voxels.nodes.clone(),
            first_faces: voxels.first_faces.clone(),
            radiance: radiance.clone(),
            held: None,
            changed: ChangedCells::new(&device, &self.grid, nodes(voxels)),
        };
        let mut wrong = None;
        if let (Some(earlier), Some(old)) = (self.bound.take(), old) {
            self.compare_lists(recorder, old, voxels, (&bound, &bits));
            let held = earlier.held.filter(|_| !all);
            bound.held = held.map(|held| self.carry(recorder, old, voxels, (&bound, &bits), &held));
            if lists_wrong {
                let mut cells = ChangedCells::new(&device, &self.grid, nodes(old) + nodes(voxels));
                let list = (bound.bits(&bits), false);
                self.lister.list(recorder, &self.globals, &self.grid, list, &mut cells);
                wrong = Some(cells);
            }
        } else {
            recorder.copy((&voxels.occupancy, 0), (&bits, 0), bytes);
        }
        self.bound = Some(bound);
        self.is_list_new = true;
        self.bits = Some(bits);
        wrong
    }

    fn compare_lists(
        &self,
        recorder: &mut Recorder,
        old: &VoxelList,
        voxels: &VoxelList,
        (bound, bits): (&Bound, &Buffer),
    ) {
        let device = recorder.device().clone();
        let gone = BindGroupBuilder::new(&self.gone_layout)
            .buffer(&bound.params)
            .buffer(&old.occupancy)
            .buffer(&voxels.occupancy)
            .buffer(bits)
            .build(&device, "gone voxels");
        let words = level_first_word(&self.grid, 1);
        self.gone.run_linear(recorder, &[&self.globals, &gone], words);
        let moved = BindGroupBuilder::new(&self.moved_layout)
            .buffer(&bound.params)
            .buffer(&voxels.nodes)
            .buffer(&voxels.first_faces)
            .buffer(&voxels.faces)
            .buffer(&old.occupancy)
            .buffer(&old.ranks)
            .buffer(&old.first_faces)
            .buffer(&old.faces)
            .buffer(bits)
            .build(&device, "moved voxels");
        self.moved.run_linear(recorder, &[&self.globals, &moved], bound.voxel_count);
        self.pyramid.fill(recorder, &self.globals, &self.grid, bits);
    }

    fn carry(
        &self,
        recorder: &mut Recorder,
        old: &VoxelList,
        voxels: &VoxelList,
        (bound, bits): (&Bound, &Buffer),
        old_held: &Buffer,
    ) -> Buffer {
        let device = recorder.device().clone();
        let held = storage_buffer(&device, "held radiance", bound.radiance.size());
        let carry = BindGroupBuilder::new(&self.carry_layout)
            .buffer(&bound.params)
            .buffer(&voxels.nodes)
            .buffer(&voxels.first_faces)
            .buffer(&old.occupancy)
            .buffer(&old.ranks)
            .buffer(&old.first_faces)
            .buffer(old_held)
            .buffer(bits)
            .buffer(&held)
            .build(&device, "carried light");
        self.carry.run_linear(recorder, &[&self.globals, &carry], bound.voxel_count);
        held
    }

    /// Before surfaces are needed, whatever their light: the cells that lack those of the current
    /// list; none if the volume has them.
    pub(crate) fn surfaces(&mut self, recorder: &mut Recorder) -> Option<&ChangedCells> {
        if self.is_list_new { self.list(recorder) } else { None }
    }

    /// Before all cells are stored: every occupied one. The volume's content is not remembered.
    pub(crate) fn all(&mut self, recorder: &mut Recorder) -> Option<&ChangedCells> {
        let (bits, bound) = self.bits.as_ref().zip(self.bound.as_mut())?;
        recorder.copy((&bound.occupancy, 0), (bits, 0), bits.size());
        bound.held = None;
        self.is_list_new = false;
        self.list(recorder)
    }

    /// Before the current radiance is stored: the cells that do not hold it. If the volume's
    /// content is not known, that is every occupied cell. Afterwards it is known.
    pub(crate) fn find(&mut self, recorder: &mut Recorder) -> Option<&ChangedCells> {
        let (bits, bound) = self.bits.as_ref().zip(self.bound.as_ref())?;
        let device = recorder.device().clone();
        let Some(held) = &bound.held else {
            let bytes = bound.radiance.size();
            let held = storage_buffer(&device, "held radiance", bytes);
            recorder.copy((&bound.radiance, 0), (&held, 0), bytes);
            self.all(recorder);
            let bound = self.bound.as_mut()?;
            bound.held = Some(held);
            return Some(&bound.changed);
        };
        if !self.is_list_new {
            recorder.clear(bits);
        }
        let relit = BindGroupBuilder::new(&self.relit_layout)
            .buffer(&bound.params)
            .buffer(&bound.nodes)
            .buffer(&bound.first_faces)
            .buffer(&bound.radiance)
            .buffer(held)
            .buffer(bits)
            .build(&device, "relit voxels");
        self.relit.run_linear(recorder, &[&self.globals, &relit], bound.voxel_count);
        self.pyramid.fill(recorder, &self.globals, &self.grid, bits);
        self.is_list_new = false;
        self.list(recorder)
    }

    /// Lists the occupied cells whose bits are set.
    fn list(&mut self, recorder: &mut Recorder) -> Option<&ChangedCells> {
        let (bits, bound) = self.bits.as_ref().zip(self.bound.as_mut())?;
        let Bound { occupancy, ranks, changed, .. } = bound;
        let list = (Bits { changed: bits, occupancy, ranks }, true);
        self.lister.list(recorder, &self.globals, &self.grid, list, changed);
        Some(changed)
    }

    /// The list of cells that [`Self::surfaces`], [`Self::all`] and [`Self::find`] fill.
    pub(crate) fn cells(&self) -> Option<&ChangedCells> {
        self.bound.as_ref().map(|bound| &bound.changed)
    }

    /// Forgets the volume's content, so that all is stored the next time.
    pub(crate) fn forget(&mut self) {
        if let Some(bound) = &mut self.bound {
            bound.held = None;
        }
    }

    /// A bit per cell, laid out as the list's occupancy, once there is a list: the last result of
    /// [`Self::rebuild`], [`Self::all`] or [`Self::find`].
    pub(crate) fn bits(&self) -> Option<&Buffer> {
        self.bits.as_ref()
    }

    /// Bytes on the GPU, by use.
    pub(crate) fn memory(&self) -> Vec<(&'static str, u64)> {
        let held = self.bound.as_ref().and_then(|bound| bound.held.as_ref());
        let size = |buffer: Option<&Buffer>| buffer.map_or(0, |buffer| buffer.size());
        let cells = self.cells().map_or(0, ChangedCells::bytes);
        let mut memory = vec![("voxels: changed cells", size(self.bits.as_ref()) + cells)];
        if held.is_some() {
            memory.push(("light: held radiance of the faces", size(held)));
        }
        memory
    }
}
