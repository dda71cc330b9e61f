//! The list from the bits: the pyramid of occupancy, ranks and nodes.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, Scan,
    ShaderError, ShaderLibrary, uniform_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::voxels::NodeRecord;
use crate::voxels::pyramid::{Pyramid, level_first_word, level_words};
use crate::{GiError, Grid};

/// `InnerParams` of `inner_lobes.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct InnerParams {
    first_node: u32,
    end_node: u32,
    child_first_word: u32,
}

/// The occupancy bits of all levels with their ranks, before the list is made.
#[derive(Debug)]
pub(crate) struct Occupied {
    /// A bit per cell.
    pub occupancy: Buffer,
    /// The bits before each word, and last the total.
    pub ranks: Buffer,
}

/// The kernels that make the list.
#[derive(Debug)]
pub(crate) struct ListBuilder {
    rank_layout: wgpu::BindGroupLayout,
    cells_layout: wgpu::BindGroupLayout,
    inner_layout: wgpu::BindGroupLayout,
    pub pyramid: Pyramid,
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
            count: Kernel::new(device, shaders, "voxels::rank", "count", &ranks)?,
            list: Kernel::new(device, shaders, "voxels::rank", "list", &ranks)?,
            cells: Kernel::new(device, shaders, "voxels::cells", "main", &cells)?,
            inner_lobes: Kernel::new(device, shaders, "voxels::inner_lobes", "main", &inner)?,
            rank_layout,
            cells_layout,
            inner_layout,
        })
    }

    /// Buffers for the bits, all zero.
    ///
    /// # Errors
    /// [`GiError::Limit`] when they do not fit.
    pub fn begin(memory: &mut Memory<'_>, grid: &Grid) -> Result<Occupied, GiError> {
        let words = level_first_word(grid, grid.levels);
        let remedy = Remedy::Volume(grid.dimensions.max_element());
        Ok(Occupied {
            occupancy: memory.buffer("occupancy", words, 4, remedy)?,
            ranks: memory.buffer("ranks", words + 1, 4, remedy)?,
        })
    }

    /// Ranks the cells of all levels.
    pub fn rank(
        &self,
        recorder: &mut Recorder,
        scan: &Scan,
        globals: &BindGroup,
        grid: &Grid,
        occupied: &Occupied,
    ) {
        let device = recorder.device().clone();
        let words = level_first_word(grid, grid.levels);
        // The nodes are not there yet: `count` does not touch them.
        let unused = crate::gpu::storage_buffer(&device, "no nodes", 16);
        let group = self.rank_group(&device, occupied, &unused);
        self.count.run_linear(recorder, &[globals, &group], words);
        scan.run(recorder, &occupied.ranks, words as u32 + 1);
    }

    /// Bits and ranks of the finest level's words side by side (`array<vec2u>`): one binding for
    /// kernels that have none to spare.
    ///
    /// # Errors
    /// [`GiError::Limit`] when they do not fit.
    pub fn cells(
        &self,
        recorder: &mut Recorder,
        memory: &mut Memory<'_>,
        globals: &BindGroup,
        grid: &Grid,
        occupied: &Occupied,
    ) -> Result<Buffer, GiError> {
        let words = level_words(grid, 0);
        let remedy = Remedy::Volume(grid.dimensions.max_element());
        let cells = memory.buffer("cells", words, 8, remedy)?;
        let group = BindGroupBuilder::new(&self.cells_layout)
            .buffer(&occupied.occupancy)
            .buffer(&occupied.ranks)
            .buffer(&cells)
            .build(memory.device(), "voxels::cells");
        self.cells.run_linear(recorder, &[globals, &group], words);
        Ok(cells)
    }

    /// Copies where the nodes of each level start, and their total, to `counts` at the byte
    /// `place`.
    pub fn copy_level_starts(
        recorder: &mut Recorder,
        grid: &Grid,
        occupied: &Occupied,
        (counts, place): (&Buffer, u64),
    ) {
        for level in 0..=grid.levels {
            let word = level_first_word(grid, level);
            let place = place + u64::from(level) * 4;
            recorder.copy((&occupied.ranks, word * 4), (counts, place), 4);
        }
    }

    /// The nodes, still without lobes.
    ///
    /// # Errors
    /// [`GiError::Limit`] when they do not fit.
    pub fn list(
        &self,
        recorder: &mut Recorder,
        memory: &mut Memory<'_>,
        globals: &BindGroup,
        grid: &Grid,
        occupied: &Occupied,
        node_count: u32,
    ) -> Result<Buffer, GiError> {
        let remedy = Remedy::Surface(grid.dimensions.max_element());
        let stride = size_of::<NodeRecord>() as u64;
        let nodes = memory.buffer("nodes", u64::from(node_count), stride, remedy)?;
        let group = self.rank_group(memory.device(), occupied, &nodes);
        let words = level_first_word(grid, grid.levels);
        self.list.run_linear(recorder, &[globals, &group], words);
        Ok(nodes)
    }

    /// The lobes of the inner nodes, from those of the finest level.
    pub fn inner_lobes(
        &self,
        recorder: &mut Recorder,
        globals: &BindGroup,
        grid: &Grid,
        occupied: &Occupied,
        nodes: &Buffer,
        level_starts: &[u32],
    ) {
        let device = recorder.device().clone();
        let groups: Vec<_> = (1..grid.levels)
            .map(|level| {
                let params = InnerParams {
                    first_node: level_starts[level as usize],
                    end_node: level_starts[level as usize + 1],
                    child_first_word: level_first_word(grid, level - 1) as u32,
                };
                let uniform = uniform_buffer(&device, "inner lobes parameters", &params);
                let group = BindGroupBuilder::new(&self.inner_layout)
                    .buffer(&uniform)
                    .buffer(&occupied.occupancy)
                    .buffer(&occupied.ranks)
                    .buffer(nodes)
                    .build(&device, "voxels::inner_lobes");
                (group, u64::from(params.end_node - params.first_node))
            })
            .collect();
        recorder.compute("voxels::inner_lobes", |pass| {
            for (group, count) in &groups {
                self.inner_lobes.dispatch_linear(pass, &[globals, group], *count);
            }
        });
    }

    fn rank_group(&self, device: &wgpu::Device, occupied: &Occupied, nodes: &Buffer) -> BindGroup {
        BindGroupBuilder::new(&self.rank_layout)
            .buffer(&occupied.occupancy)
            .buffer(&occupied.ranks)
            .buffer(nodes)
            .build(device, "voxels::rank")
    }
}

#[cfg(test)]
mod tests {
    use super::InnerParams;
    use crate::voxels::pyramid::PyramidParams;

    #[test]
    fn structs_lie_in_memory_alike() {
        let library = crate::shaders::library();
        library.check_struct::<PyramidParams>("voxels::pyramid", "PyramidParams").unwrap();
        library.check_struct::<InnerParams>("voxels::inner_lobes", "InnerParams").unwrap();
    }
}
