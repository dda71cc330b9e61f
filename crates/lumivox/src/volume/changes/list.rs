//! Lists of changed cells, made from their bits.

use bytemuck::{Pod, Zeroable};

use crate::GiError;
use crate::Grid;
use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundIndirect, BoundScan, Buffer, ComputePass, Indirect, Kernel,
    LayoutBuilder, Pipelines, Recorder, Run, Scan, ShaderLibrary, storage_buffer, uniform_buffer,
};
use crate::voxels::{VoxelList, level_first_word};

/// `ListParams` of `list.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ListParams {
    pub(crate) only_occupied: u32,
}

/// `LevelWords` of `cells.wgsl`: the place of a level's bits.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct LevelWords {
    pub(crate) level: u32,
    pub(crate) first_word: u32,
    pub(crate) end_word: u32,
}

impl LevelWords {
    /// The uniforms of each level of a grid.
    pub(crate) fn of_levels(device: &wgpu::Device, grid: &Grid) -> Vec<Buffer> {
        let words = |level: u32| Self {
            level,
            first_word: level_first_word(grid, level) as u32,
            end_word: level_first_word(grid, level + 1) as u32,
        };
        (0..grid.levels).map(|l| uniform_buffer(device, "level words", &words(l))).collect()
    }
}

/// Changed cells, level by level, and the dispatches over them.
#[derive(Debug)]
pub(crate) struct ChangedCells {
    /// For each word of the bits, the number of cells before it, and the total.
    pub(crate) ranks: Buffer,
    /// `array<ChangedCell>` of `list.wgsl`.
    pub(crate) cells: Buffer,
    words: u64,
    group: BindGroup,
    scan: BoundScan,
    /// The arguments of a dispatch over each level's cells.
    levels: BoundIndirect,
}

impl ChangedCells {
    /// Runs a kernel with at least one thread per changed cell of a level:
    /// `package::volume::changes::cells` returns a thread's cell.
    pub(crate) fn dispatch(
        &self,
        pass: &mut ComputePass<'_>,
        kernel: &Kernel,
        groups: &[&BindGroup],
        level: usize,
    ) {
        let offset = level as u64 * Indirect::STRIDE;
        kernel.dispatch_indirect(pass, groups, &self.levels.arguments, offset);
    }

    /// Bytes on the GPU.
    pub(super) fn bytes(&self) -> u64 {
        self.ranks.size() + self.cells.size()
    }
}

/// Kernels that list changed cells.
#[derive(Debug)]
pub(super) struct Lister {
    layout: wgpu::BindGroupLayout,
    count: Kernel,
    list: Kernel,
    scan: Scan,
    indirect: Indirect,
    /// A zero, bound for "no overflow".
    zero: Buffer,
}

impl Lister {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let layout = (0..3).fold(LayoutBuilder::compute().uniform(), |layout, _| layout.storage());
        let layout = layout.storage_mut().storage_mut().build(device, "changed cells");
        let kernel = |entry| {
            Kernel::new(device, shaders, "volume::changes::list", entry, &[globals, &layout])
        };
        Ok(Self {
            count: kernel("count")?,
            list: kernel("list")?,
            scan: Scan::new(device, shaders)?,
            indirect: Indirect::new(device, shaders)?,
            zero: storage_buffer(device, "no overflow", 16),
            layout,
        })
    }

    /// Creates lists for up to `count` cells, at least the number of set bits; with
    /// `only_occupied`, empty cells are skipped.
    pub(super) fn cells(
        &self,
        device: &wgpu::Device,
        grid: &Grid,
        (bits, voxels): (&Buffer, &VoxelList),
        count: u64,
        only_occupied: bool,
    ) -> ChangedCells {
        let words = level_first_word(grid, grid.levels);
        let ranks = storage_buffer(device, "ranks of changed cells", (words + 1) * 4);
        let cells = storage_buffer(device, "changed cells", count * 8);
        let params = ListParams { only_occupied: u32::from(only_occupied) };
        let params = uniform_buffer(device, "list parameters", &params);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&params)
            .buffer(&voxels.occupancy)
            .buffer(&voxels.ranks)
            .buffer(bits)
            .buffer(&ranks)
            .buffer(&cells)
            .build(device, "changed cells");
        let first_word = |level: u32| level_first_word(grid, level) as u32;
        let levels: Vec<Run> = (0..grid.levels)
            .map(|level| Run { first: first_word(level), end: first_word(level + 1) })
            .collect();
        ChangedCells {
            scan: self.scan.bind(device, &ranks, words as u32 + 1),
            levels: self.indirect.bind(device, &ranks, &levels, &self.zero),
            ranks,
            cells,
            words,
            group,
        }
    }

    /// Lists the changed cells.
    pub(super) fn list(
        &self,
        recorder: &mut Recorder<'_>,
        globals: &BindGroup,
        cells: &ChangedCells,
    ) {
        let groups = [globals, &cells.group];
        self.count.run_linear(recorder, &groups, cells.words);
        self.scan.run_bound(recorder, &cells.scan);
        self.list.run_linear(recorder, &groups, cells.words);
        self.indirect.run(recorder, &cells.levels);
    }
}
