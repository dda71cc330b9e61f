//! Which nodes there are, and how they hang together.

use super::GROWTH;
use super::layout::TreeLayout;
use super::locks::LockBuilder;
use super::{Input, OctreeBuilder, OctreeStats};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, Scan,
    ShaderLibrary, read_buffer, uniform_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::volume::budget;
use crate::voxels::{BitLevel, LIST_COUNT_BYTES, Pyramid, VoxelList, level_arguments, level_block};
use crate::{GiError, Grid};

/// The nodes of a voxel list's octree, still without bricks.
#[derive(Debug)]
pub(super) struct Topology {
    pub layout: TreeLayout,
    /// [`super::TreeUniform`].
    pub tree: Buffer,
    /// The table and the nodes.
    pub octree: Buffer,
    /// `Site` for each slot.
    pub sites: Buffer,
    /// Places for nodes.
    pub slots: u32,
    pub stats: OctreeStats,
}

/// The order of the nodes by ranks: what bricks are numbered by.
#[derive(Debug)]
pub(super) struct NodeRanks {
    /// A bit for each node below the root, level 1 first.
    pub node_bits: Buffer,
    /// Groups before each word of `node_bits`.
    pub group_ranks: Buffer,
}

/// The kernels that make them.
#[derive(Debug)]
pub(super) struct TopologyKernels {
    scan: Scan,
    pyramid: Pyramid,
    /// Group 0: the grid and the tree.
    tree_layout: wgpu::BindGroupLayout,
    occupy_layout: wgpu::BindGroupLayout,
    groups_layout: wgpu::BindGroupLayout,
    build_layout: wgpu::BindGroupLayout,
    table_layout: wgpu::BindGroupLayout,
    occupy: Kernel,
    count_groups: Kernel,
    build: Kernel,
    table: Kernel,
    locks: Option<LockBuilder>,
}

impl TopologyKernels {
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        builder: OctreeBuilder,
    ) -> Result<Self, GiError> {
        let compute = LayoutBuilder::compute;
        let tree_layout = compute().uniform().uniform().build(device, "volume::octree::tree");
        let occupy_layout =
            compute().uniform().storage().storage_mut().build(device, "volume::octree::occupy");
        let groups_layout =
            compute().storage().storage_mut().build(device, "volume::octree::groups");
        let build_layout = compute()
            .storage()
            .storage()
            .storage_mut()
            .storage_mut()
            .build(device, "volume::octree::build_ranked");
        let table_layout = compute().storage().storage_mut().build(device, "volume::octree::table");
        let kernel = |module: &str, entry: &str, layout: &wgpu::BindGroupLayout| {
            Kernel::new(device, shaders, module, entry, &[&tree_layout, layout])
        };
        let locks = match builder {
            OctreeBuilder::Ranks => None,
            OctreeBuilder::Locks => Some(LockBuilder::new(device, shaders, &tree_layout)?),
        };
        Ok(Self {
            scan: Scan::new(device, shaders)?,
            pyramid: Pyramid::new(device, shaders, &tree_layout)?,
            occupy: kernel("volume::octree::occupy", "main", &occupy_layout)?,
            count_groups: kernel("volume::octree::groups", "count", &groups_layout)?,
            build: kernel("volume::octree::build_ranked", "main", &build_layout)?,
            table: kernel("volume::octree::table", "main", &table_layout)?,
            locks,
            tree_layout,
            occupy_layout,
            groups_layout,
            build_layout,
            table_layout,
        })
    }

    /// Builds the nodes of a list. Waits for a count of them, to allocate no more than they need.
    pub async fn build(
        &self,
        recorder: &mut Recorder<'_>,
        input: &Input<'_>,
    ) -> Result<(Topology, NodeRanks), GiError> {
        let Input { grid, grid_uniform, voxels, memory_budget } = *input;
        let device = recorder.device().clone();
        let queue = recorder.queue().clone();
        let layout = TreeLayout::new(grid);
        let tree = uniform_buffer(&device, "octree", &layout.uniform(1, 1));
        let globals = BindGroupBuilder::new(&self.tree_layout)
            .buffer(grid_uniform)
            .buffer(&tree)
            .build(&device, "volume::octree::tree");
        let resolution = grid.dimensions.max_element();
        let mut memory = Memory::new(&device);
        let words = u64::from(layout.bit_words());
        // The root has a word as well, so that the pyramid may end in it.
        let node_bits =
            memory.buffer("octree: node bits", words + 1, 4, Remedy::Volume(resolution))?;
        let group_ranks =
            memory.buffer("octree: group ranks", words + 1, 4, Remedy::Volume(resolution))?;

        self.mark_nodes(recorder, &globals, grid, &layout, voxels, &node_bits);
        let groups_group = BindGroupBuilder::new(&self.groups_layout)
            .buffer(&node_bits)
            .buffer(&group_ranks)
            .build(&device, "volume::octree::groups");
        self.count_groups.run_linear(recorder, &[&globals, &groups_group], words);
        self.scan.run(recorder, &group_ranks, layout.bit_words() + 1);
        recorder.flush();
        let counted: Vec<u32> =
            read_buffer(&device, &queue, &group_ranks, words * 4..words * 4 + 4).await?;
        let groups = 1 + counted[0];
        let slots = u64::from(groups) * 8;
        let octree_words = layout.words(slots);
        let needed = octree_words * 4 + slots * 8;
        budget::check("the list of the octree's nodes", needed, memory_budget, grid, GROWTH)?;
        let octree =
            memory.buffer("octree: nodes", octree_words, 4, Remedy::Surface(resolution))?;
        let sites = memory.buffer("octree: sites", slots, 8, Remedy::Surface(resolution))?;
        let slots = slots as u32;
        queue.write_buffer(&tree, 0, bytemuck::bytes_of(&layout.uniform(slots, 1)));

        let mut stats = OctreeStats { groups, ..OctreeStats::default() };
        if let Some(locks) = &self.locks {
            let done = locks
                .build(recorder, &mut memory, &globals, grid, voxels, (groups, &octree, &sites))
                .await?;
            stats.lock_passes = done.passes;
            stats.deferred = done.deferred;
        } else {
            let group = BindGroupBuilder::new(&self.build_layout)
                .buffer(&node_bits)
                .buffer(&group_ranks)
                .buffer(&octree)
                .buffer(&sites)
                .build(&device, "volume::octree::build_ranked");
            self.build.run_linear(recorder, &[&globals, &group], words.max(1));
        }
        let group = BindGroupBuilder::new(&self.table_layout)
            .buffer(&sites)
            .buffer(&octree)
            .build(&device, "volume::octree::table");
        self.table.run_linear(recorder, &[&globals, &group], u64::from(slots));
        let topology = Topology { layout, tree, octree, sites, slots, stats };
        Ok((topology, NodeRanks { node_bits, group_ranks }))
    }

    /// Sets the bit of every node: those that cells need, and the way to them from the root.
    fn mark_nodes(
        &self,
        recorder: &mut Recorder,
        globals: &BindGroup,
        grid: &Grid,
        layout: &TreeLayout,
        voxels: &VoxelList,
        node_bits: &Buffer,
    ) {
        let device = recorder.device().clone();
        let groups: Vec<_> = (0..grid.levels)
            .map(|level| {
                BindGroupBuilder::new(&self.occupy_layout)
                    .slice(&voxels.counts, level_block(level), LIST_COUNT_BYTES)
                    .buffer(&voxels.nodes)
                    .buffer(node_bits)
                    .build(&device, "volume::octree::occupy")
            })
            .collect();
        recorder.compute("volume::octree::occupy", |pass| {
            for (level, group) in (0..).zip(&groups) {
                let arguments = level_arguments(level);
                let groups = [globals, group];
                self.occupy.dispatch_indirect(pass, &groups, &voxels.counts, arguments);
            }
        });
        let levels: Vec<BitLevel> =
            (grid.levels..=layout.root_level).map(|level| layout.bits(level)).collect();
        let levels = self.pyramid.bind_levels(&device, node_bits, &levels);
        self.pyramid.run(recorder, globals, &levels);
    }
}
