//! Builds the list from occupancy bits: ranks and nodes.

use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundScan, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder,
    Scan, ShaderError, ShaderLibrary, storage_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::voxels::pyramid::{Pyramid, level_first_word, level_words};
use crate::voxels::{LIST_COUNT_BYTES, VoxelList, level_arguments, level_block};
use crate::{GiError, Grid};

/// The occupancy bits of the finest level or of all, and their ranks.
#[derive(Debug)]
pub(crate) struct RankedBits {
    /// A bit per cell.
    pub occupancy: Buffer,
    /// The number of bits before each word, and the total at the end.
    pub ranks: Buffer,
    words: u64,
    group: BindGroup,
    scan: BoundScan,
}

impl RankedBits {
    /// Byte offset of the total among the ranks.
    pub fn total_byte(&self) -> u64 {
        self.words * 4
    }

    /// Bytes on the GPU.
    pub fn bytes(&self) -> u64 {
        self.occupancy.size() + self.ranks.size()
    }
}

/// Bits and ranks of the finest level's words side by side (`array<vec2u>`): one binding instead of
/// two, for kernels near the limit.
#[derive(Debug)]
pub(crate) struct Cells {
    /// The pairs.
    pub buffer: Buffer,
    words: u64,
    group: BindGroup,
}

/// Bindings of [`ListBuilder::fill_nodes`].
#[derive(Debug)]
pub(crate) struct BoundNodes {
    words: u64,
    group: BindGroup,
}

/// Bindings of [`ListBuilder::inner_lobes`].
#[derive(Debug)]
pub(crate) struct BoundInner {
    /// Bind groups of each level except the finest.
    groups: Vec<BindGroup>,
    counts: Buffer,
}

/// The kernels that build the list.
#[derive(Debug)]
pub(crate) struct ListBuilder {
    rank_layout: wgpu::BindGroupLayout,
    cells_layout: wgpu::BindGroupLayout,
    inner_layout: wgpu::BindGroupLayout,
    pub pyramid: Pyramid,
    scan: Scan,
    count: Kernel,
    list: Kernel,
    cells: Kernel,
    inner_lobes: Kernel,
}

impl ListBuilder {
    /// Compiles the kernels; group 0 is the grid.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, ShaderError> {
        let rank_layout = LayoutBuilder::compute()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "voxels::rank");
        let cells_layout = LayoutBuilder::compute()
            .storage()
            .storage()
            .storage_mut()
            .build(device, "voxels::cells");
        let inner_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage()
            .storage_mut()
            .build(device, "voxels::inner_lobes");
        let ranks = [globals, &rank_layout];
        let cells = [globals, &cells_layout];
        let inner = [globals, &inner_layout];
        Ok(Self {
            pyramid: Pyramid::new(device, shaders, globals)?,
            scan: Scan::new(device, shaders)?,
            count: Kernel::new(device, shaders, "voxels::rank", "count", &ranks)?,
            list: Kernel::new(device, shaders, "voxels::rank", "list", &ranks)?,
            cells: Kernel::new(device, shaders, "voxels::cells", "main", &cells)?,
            inner_lobes: Kernel::new(device, shaders, "voxels::inner_lobes", "main", &inner)?,
            rank_layout,
            cells_layout,
            inner_layout,
        })
    }

    /// Zeroed bits of the first `levels` levels of a grid.
    ///
    /// # Errors
    /// [`GiError::Limit`] when they do not fit.
    pub fn bits(
        &self,
        memory: &mut Memory<'_>,
        grid: &Grid,
        levels: u32,
    ) -> Result<RankedBits, GiError> {
        let words = level_first_word(grid, levels);
        let remedy = Remedy::Volume(grid.dimensions.max_element());
        let occupancy = memory.buffer("occupancy", words, 4, remedy)?;
        let ranks = memory.buffer("ranks", words + 1, 4, remedy)?;
        let device = memory.device();
        // Counting does not write nodes.
        let unused = storage_buffer(device, "no nodes", 16);
        let group = self.rank_group(device, [&occupancy, &ranks, &unused]);
        let scan = self.scan.bind(device, &ranks, words as u32 + 1);
        Ok(RankedBits { occupancy, ranks, words, group, scan })
    }

    /// Computes the ranks of the cells.
    pub fn rank(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, bits: &RankedBits) {
        self.count.run_linear(recorder, &[globals, &bits.group], bits.words);
        self.scan.run_bound(recorder, &bits.scan);
    }

    /// Allocates [`Cells`].
    ///
    /// # Errors
    /// [`GiError::Limit`] when they do not fit.
    pub fn cells(
        &self,
        memory: &mut Memory<'_>,
        grid: &Grid,
        bits: &RankedBits,
    ) -> Result<Cells, GiError> {
        let words = level_words(grid, 0);
        let remedy = Remedy::Volume(grid.dimensions.max_element());
        let buffer = memory.buffer("cells", words, 8, remedy)?;
        let group = BindGroupBuilder::new(&self.cells_layout)
            .buffer(&bits.occupancy)
            .buffer(&bits.ranks)
            .buffer(&buffer)
            .build(memory.device(), "voxels::cells");
        Ok(Cells { buffer, words, group })
    }

    /// Fills cells from bits and ranks.
    pub fn fill_cells(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, cells: &Cells) {
        self.cells.run_linear(recorder, &[globals, &cells.group], cells.words);
    }

    /// Creates the bindings of [`Self::fill_nodes`].
    pub fn bind_nodes(
        &self,
        device: &wgpu::Device,
        [occupancy, ranks, nodes]: [&Buffer; 3],
    ) -> BoundNodes {
        let group = self.rank_group(device, [occupancy, ranks, nodes]);
        BoundNodes { words: occupancy.size() / 4, group }
    }

    /// Fills the nodes, except for their lobes.
    pub fn fill_nodes(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, bound: &BoundNodes) {
        self.list.run_linear(recorder, &[globals, &bound.group], bound.words);
    }

    /// Creates the bindings of [`Self::inner_lobes`].
    pub fn bind_inner(&self, device: &wgpu::Device, grid: &Grid, list: &VoxelList) -> BoundInner {
        let group = |level| {
            BindGroupBuilder::new(&self.inner_layout)
                .slice(&list.counts, level_block(level), LIST_COUNT_BYTES)
                .buffer(&list.occupancy)
                .buffer(&list.ranks)
                .buffer(&list.nodes)
                .build(device, "voxels::inner_lobes")
        };
        BoundInner { groups: (1..grid.levels).map(group).collect(), counts: list.counts.clone() }
    }

    /// Computes the lobes of the inner nodes from those of the finest level.
    pub fn inner_lobes(
        &self,
        recorder: &mut Recorder<'_>,
        globals: &BindGroup,
        bound: &BoundInner,
    ) {
        recorder.compute("voxels::inner_lobes", |pass| {
            for (level, group) in (1..).zip(&bound.groups) {
                let arguments = level_arguments(level);
                let groups = [globals, group];
                self.inner_lobes.dispatch_indirect(pass, &groups, &bound.counts, arguments);
            }
        });
    }

    fn rank_group(&self, device: &wgpu::Device, buffers: [&Buffer; 3]) -> BindGroup {
        let group = BindGroupBuilder::new(&self.rank_layout);
        buffers.into_iter().fold(group, BindGroupBuilder::buffer).build(device, "voxels::rank")
    }
}

#[cfg(test)]
mod tests {
    use lumivox_reflect::check_struct;

    use crate::voxels::pyramid::PyramidParams;
    use crate::voxels::{ListCounts, NodeRange};

    #[test]
    fn rust_and_wgsl_structs_have_the_same_layout() {
        let library = &crate::shaders::library();
        check_struct::<PyramidParams>(library, "voxels::pyramid", "PyramidParams");
        check_struct::<ListCounts>(library, "voxels::counts", "ListCounts");
        check_struct::<NodeRange>(library, "voxels::counts", "NodeRange");
    }
}
