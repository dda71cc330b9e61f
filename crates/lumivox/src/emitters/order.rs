//! The list's order and the tree over it, rebuilt with the list.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Memory, Pipelines, Recorder,
    Remedy, ShaderLibrary, storage_buffer, uniform_buffer,
};
use crate::{GiError, Grid};

use super::{EmitterRecord, HEADER_BYTES};

/// `Sorting` of `order.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, Pod, Zeroable)]
pub(crate) struct Sorting {
    count: u32,
    run: u32,
    distance: u32,
    cells_per_voxel: f32,
}

/// `TreePart` of `tree.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct TreePart {
    count: u32,
    level: u32,
    padding: [u32; 2],
}

/// Invocations per workgroup that sorts.
pub(super) const SORT_WORKGROUP_SIZE: u32 = 256;
/// Keys that one workgroup sorts: two per invocation.
pub(super) const SORT_BLOCK: u32 = 2 * SORT_WORKGROUP_SIZE;

/// Nodes of the first level that a workgroup builds in one pass: one per invocation.
pub(super) const TREE_PASS_NODES: u32 = 256;
/// Levels of a pass: each has half as many nodes, down to one.
pub(super) const TREE_PASS_LEVELS: u32 = TREE_PASS_NODES.ilog2() + 1;

/// Cells of the Morton curve along the longest edge of all boxes: 10 bits per axis.
const MORTON_CELLS: f32 = 1024.0;

/// Cells of the Morton curve along the edge of a finest voxel.
fn cells_per_voxel(grid: &Grid) -> f32 {
    let coarser = 2.0_f32.powi(grid.box_count() as i32 - 1);
    MORTON_CELLS / (grid.box_dimensions().max_element() as f32 * coarser)
}

/// Levels of nodes above `count` emitters.
fn levels_above(count: u32) -> u32 {
    count.max(1).next_power_of_two().trailing_zeros()
}

/// Emitters and nodes of a list together.
fn records(count: u64) -> u64 {
    let nodes = (1..=levels_above(count as u32)).map(|level| count.div_ceil(1 << level));
    count + nodes.sum::<u64>()
}

/// The kernels, the unsorted emitters, and the sorted list.
#[derive(Debug)]
pub(super) struct Order {
    layout: wgpu::BindGroupLayout,
    tree_layout: wgpu::BindGroupLayout,
    sort_blocks: Kernel,
    exchange: Kernel,
    merge_blocks: Kernel,
    place: Kernel,
    tree: Kernel,
    cells_per_voxel: f32,
    unsorted: Buffer,
    keys: Buffer,
    list: Buffer,
    steps: Vec<Step>,
}

/// A dispatch of a kernel.
#[derive(Debug)]
struct Step {
    kernel: Kernel,
    group: BindGroup,
    threads: u32,
}

impl Order {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
    ) -> Result<Self, GiError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .storage_mut()
            .storage()
            .storage_mut()
            .build(device, "emitters::order");
        let tree_layout =
            LayoutBuilder::compute().uniform().storage_mut().build(device, "emitters::tree");
        let kernel =
            |entry| Kernel::deferred(device, shaders, "emitters::order", entry, &[&layout]);
        let [sort_blocks, exchange] = [kernel("sort_blocks")?, kernel("exchange")?];
        let [merge_blocks, place] = [kernel("merge_blocks")?, kernel("place")?];
        let record = size_of::<EmitterRecord>() as u64;
        let mut order = Self {
            tree: Kernel::deferred(device, shaders, "emitters::tree", "main", &[&tree_layout])?,
            layout,
            tree_layout,
            sort_blocks,
            exchange,
            merge_blocks,
            place,
            cells_per_voxel: cells_per_voxel(grid),
            unsorted: storage_buffer(device, "unsorted emitters", record),
            keys: storage_buffer(device, "keys of emitters", u64::from(SORT_BLOCK) * 8),
            list: empty_list(device),
            steps: Vec::new(),
        };
        order.bind(device, 0);
        Ok(order)
    }

    /// Queues for compilation the kernels that lists of up to [`SORT_BLOCK`] emitters need.
    pub(super) fn expect(&self, device: &Pipelines) {
        for kernel in [&self.sort_blocks, &self.place, &self.tree] {
            kernel.expect(device);
        }
    }

    /// `EmitterList` of `emitter.wgsl`.
    pub(super) fn list(&self) -> &Buffer {
        &self.list
    }

    /// The emitters before they are sorted (`array<Emitter>`).
    pub(super) fn unsorted(&self) -> &Buffer {
        &self.unsorted
    }

    /// Bytes on the GPU.
    pub(super) fn bytes(&self) -> u64 {
        self.list.size() + self.unsorted.size() + self.keys.size()
    }

    /// Allocates buffers for `count` emitters; returns `true` if they are new.
    ///
    /// # Errors
    /// [`GiError::Limit`] when the device cannot hold them.
    pub(super) fn reserve(&mut self, device: &wgpu::Device, count: u64) -> Result<bool, GiError> {
        let record = size_of::<EmitterRecord>() as u64;
        let bytes = HEADER_BYTES + records(count) * record;
        let has_grown = bytes > self.list.size();
        if has_grown {
            let memory = Memory::new(device);
            let keys = count.next_power_of_two().max(SORT_BLOCK.into());
            self.list = memory.buffer("emitters", bytes / 16, 16, Remedy::Batch)?;
            self.unsorted = memory.buffer("unsorted emitters", count, record, Remedy::Batch)?;
            self.keys = memory.buffer("keys of emitters", keys, 8, Remedy::Batch)?;
        }
        self.bind(device, count as u32);
        Ok(has_grown)
    }

    /// Creates the steps that sort `count` emitters and build the tree.
    fn bind(&mut self, device: &wgpu::Device, count: u32) {
        self.steps.clear();
        let keys = count.next_power_of_two().max(SORT_BLOCK);
        let sorting =
            Sorting { count, cells_per_voxel: self.cells_per_voxel, ..Sorting::default() };
        let step = |kernel: &Kernel, threads: u32, sorting: &Sorting| Step {
            kernel: kernel.clone(),
            group: BindGroupBuilder::new(&self.layout)
                .buffer(&uniform_buffer(device, "sorting of emitters", sorting))
                .buffer(&self.keys)
                .buffer(&self.unsorted)
                .buffer(&self.list)
                .build(device, "emitters::order"),
            threads,
        };
        let mut steps = vec![step(&self.sort_blocks, keys / 2, &sorting)];
        let mut run = 2 * SORT_BLOCK;
        while run <= keys {
            let mut distance = run / 2;
            while distance >= SORT_BLOCK {
                let sorting = Sorting { run, distance, ..sorting };
                steps.push(step(&self.exchange, keys / 2, &sorting));
                distance /= 2;
            }
            steps.push(step(&self.merge_blocks, keys / 2, &Sorting { run, ..sorting }));
            run *= 2;
        }
        steps.push(step(&self.place, count.max(1), &sorting));
        for level in (1..=levels_above(count)).step_by(TREE_PASS_LEVELS as usize) {
            let part = TreePart { count, level, padding: [0; 2] };
            let nodes = count.div_ceil(1 << level);
            let group = BindGroupBuilder::new(&self.tree_layout)
                .buffer(&uniform_buffer(device, "part of a tree", &part))
                .buffer(&self.list)
                .build(device, "emitters::tree");
            let threads = nodes.next_multiple_of(TREE_PASS_NODES);
            steps.push(Step { kernel: self.tree.clone(), group, threads });
        }
        self.steps = steps;
    }

    /// Sorts the listed emitters, and builds the tree.
    pub(super) fn record(&self, recorder: &mut Recorder<'_>) {
        for step in &self.steps {
            step.kernel.run(recorder, &[&step.group], [step.threads, 1, 1]);
        }
    }
}

/// A list without emitters, with space for one, since bindings may not be empty.
pub(crate) fn empty_list(device: &wgpu::Device) -> Buffer {
    storage_buffer(device, "emitters", HEADER_BYTES + size_of::<EmitterRecord>() as u64)
}
