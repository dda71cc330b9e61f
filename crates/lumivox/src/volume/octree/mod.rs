//! The octree: memory only for the surface, however fine the grid.
//!
//! Nodes are in groups of eight with one child pointer. Each node has, for each of its parts
//! (`../parts.wgsl`), a brick of 3x3x3 texels in one 3D texture: the node's 2x2x2 cells and a layer
//! of its neighbours', so that the hardware's trilinear filter is correct inside a brick (Crassin
//! et al. 2009, "`GigaVoxels`", and 2011, section 4.1). `tree.wgsl` defines the layout; the
//! folder's files correspond to the steps:
//!
//! | step | once per | files |
//! | --- | --- | --- |
//! | existing nodes, and those with changed cells | voxel list | `mark.wgsl`, `renewals.wgsl` |
//! | masks of the latter, and whether everything fits | voxel list | `masks.wgsl`, `needs.wgsl` |
//! | places of their bricks | voxel list | `places.wgsl` |
//! | node groups, by ranks or `hook.rs` | voxel list | `groups.wgsl`, `build_ranked.wgsl` |
//! | bricks and masks of all nodes, and the table | voxel list | `inherit.wgsl` |
//! | values that are still correct, and new bricks | voxel list | `carry.wgsl`, `refill.wgsl` |
//! | values of the cells, filtered level by level | changed light | `store.wgsl`, `filter.wgsl` |
//! | bricks, with the neighbours' layer | changed light | `fill*.wgsl` |
//! | look-ups | cone sample | `cells.wgsl`, `search.wgsl` |
//!
//! The octree is changed in place. Nodes are renumbered with each list, but a node with unchanged
//! parts keeps its bricks in place, and only changed cells are written. All buffers have spare
//! capacity. On overflow the octree keeps showing the earlier list, and applies the missed changes
//! once it has grown (`missed.wgsl`).

mod content;
mod follow;
mod hook;
mod layout;
mod stats;
#[cfg(test)]
mod tests;
mod tree;

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, OverflowReads, Overflowed, Pipelines, Recorder,
    ShaderLibrary,
};
use crate::volume::changes::ChangedCells;
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use content::{BoundContent, ContentKernels};
#[cfg(test)]
pub(crate) use follow::TreeNeeds as Needs;
use follow::{
    BoundFollow, BoundMissed, FollowKernels, OVERFLOW_BRICKS, OVERFLOW_PLACES, OVERFLOW_RENEWALS,
    State, TreeNeeds,
};
pub use hook::{OctreeBuilder, OctreeBuilding, OctreeParts, TreeToBuild};
use layout::TreeLayout;
#[cfg(test)]
pub(crate) use layout::TreeUniform;
pub use stats::OctreeStats;
#[cfg(test)]
pub(crate) use tests::read_nodes;
#[cfg(test)]
pub(crate) use tree::OldAtlas;
use tree::{Capacity, Resettler, Scratch, Tree};

/// Defines the constants that Rust and the shaders of this folder share.
pub(super) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("NODE_LEVELS", layout::NODE_LEVELS as u32)
        .constant_u32("NODE_WORDS", layout::NODE_WORDS)
        .constant_u32("BRICK_TEXELS", tree::BRICK_TEXELS)
        .constant_u32("RUN_KINDS", tree::RUN_KINDS as u32)
        .constant_u32("OVERFLOW_PLACES", OVERFLOW_PLACES)
        .constant_u32("OVERFLOW_RENEWALS", OVERFLOW_RENEWALS)
        .constant_u32("OVERFLOW_BRICKS", OVERFLOW_BRICKS);
}

/// The memory grows with this power of the resolution, like surfaces.
const GROWTH: f64 = 2.0;

/// The octree volume.
#[derive(Debug)]
pub(crate) struct OctreeVolume {
    grid: Grid,
    layout: TreeLayout,
    memory_budget: Option<u64>,
    globals_layout: wgpu::BindGroupLayout,
    globals: BindGroup,
    grid_uniform: Buffer,
    sampler: wgpu::Sampler,
    emitters: Buffer,
    follow_kernels: FollowKernels,
    /// The caller's node builder, if any.
    builder: Option<Box<dyn OctreeBuilder>>,
    content_kernels: ContentKernels,
    resettler: Resettler,
    /// Group 0 of kernels that do not need the tree's uniform.
    missed_globals: BindGroup,
    state: State,
    tree: Tree,
    scratch: Option<Scratch>,
    /// Created again when the list or the capacities change.
    following: Option<BoundFollow>,
    content: Option<BoundContent>,
    missed: Option<BoundMissed>,
    /// Read-backs of [`TreeNeeds`].
    late: OverflowReads,
    /// `true` once a list was shown.
    has_list: bool,
    stats: Option<OctreeStats>,
}

/// A list for the volume to show.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ShownList<'a> {
    /// The list.
    pub voxels: &'a VoxelList,
    /// Outgoing radiance of its faces.
    pub radiance: &'a Buffer,
    /// The list of cells that will be passed to updates.
    pub changed: &'a ChangedCells,
    /// A bit per cell, laid out like the occupancy: cells with changed surface, including removed
    /// ones.
    pub bits: &'a Buffer,
}

impl OctreeVolume {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &mut ShaderLibrary,
        grid: &Grid,
        (building, memory_budget): (Option<&dyn OctreeBuilding>, Option<u64>),
        emitters: &Buffer,
    ) -> Result<Self, GiError> {
        let grid_uniform = grid.uniform(device);
        let globals_layout = super::globals_layout(device);
        let sampler = super::sampler(device);
        let layout = TreeLayout::new(grid);
        shaders.constant_u32("OCTREE_STEPS", layout.steps());
        let follow_kernels = FollowKernels::new(device, shaders)?;
        let globals = follow_kernels.tree_layout();
        let parts = OctreeParts { device, shaders, grid, globals };
        let builder = building.map(|building| building.make(&parts)).transpose()?;
        // The size is checked once there are voxels.
        let tree = Tree::new(device, (grid, &layout), Capacity::MINIMUM, None)?;
        let around = (&grid_uniform, &sampler, emitters);
        let globals = bind_globals(device, &globals_layout, &tree, around);
        let missed_globals = BindGroupBuilder::new(follow_kernels.tree_layout())
            .buffer(&grid_uniform)
            .buffer(&tree.uniform)
            .build(device, "volume::octree::tree");
        Ok(Self {
            grid: *grid,
            layout,
            memory_budget,
            globals,
            state: State::new(device, grid),
            content_kernels: ContentKernels::new(device, shaders, grid)?,
            resettler: Resettler::new(device, shaders, follow_kernels.tree_layout())?,
            follow_kernels,
            builder,
            missed_globals,
            globals_layout,
            grid_uniform,
            sampler,
            emitters: emitters.clone(),
            tree,
            scratch: None,
            following: None,
            content: None,
            missed: None,
            late: OverflowReads::default(),
            has_list: false,
            stats: None,
        })
    }

    /// Binds another list of emitters.
    pub(super) fn bind_emitters(&mut self, device: &wgpu::Device, emitters: &Buffer) {
        self.emitters = emitters.clone();
        let around = (&self.grid_uniform, &self.sampler, emitters);
        self.globals = bind_globals(device, &self.globals_layout, &self.tree, around);
    }

    /// Releases the bind groups, before another list or resized buffers are bound.
    pub(super) fn unbind(&mut self) {
        self.content = None;
        self.stop_following();
    }

    fn stop_following(&mut self) {
        self.following = None;
        if let Some(builder) = &mut self.builder {
            builder.release();
        }
    }

    /// Call before cells with changed surface are found by their bits: adds missed changes.
    pub(crate) fn join_missed(&mut self, recorder: &mut Recorder<'_>, bits: &Buffer) {
        let kernels = &self.follow_kernels;
        let bound = self.missed.get_or_insert_with(|| {
            kernels.bind_missed(recorder.device(), &self.grid, &self.state, bits)
        });
        kernels.join_missed(recorder, &self.missed_globals, bound);
    }

    /// Shows a list, unless something overflows; correct content is kept. Queues a read-back of the
    /// overflow flags.
    pub(super) fn show(
        &mut self,
        recorder: &mut Recorder<'_>,
        shown: ShownList<'_>,
    ) -> Result<(), GiError> {
        recorder.stage("volume");
        let ShownList { voxels, radiance, changed, bits } = shown;
        let device = recorder.device().clone();
        let (kernels, needs) = (&self.follow_kernels, &self.state.needs);
        if self.scratch.is_none() {
            self.scratch = Some(Scratch::new(&device, &self.grid, &self.tree)?);
            self.following = None;
        }
        let Some(scratch) = &self.scratch else { return Ok(()) };
        if self.following.is_none() {
            let grid = (&self.grid, &self.grid_uniform, &self.layout);
            let octree = (&self.tree, scratch, &self.state);
            if let Some(builder) = &mut self.builder {
                let (places, octree, sites) =
                    (self.tree.capacity.slots, &self.tree.octree, &self.tree.sites);
                let tree = TreeToBuild { voxels, places, needs, octree, sites };
                builder.bind(&device, &tree)?;
            }
            self.following = Some(kernels.bind(&device, grid, (voxels, bits), octree));
        }
        if self.content.is_none() {
            let nodes = (&self.tree.uniform, &self.tree.octree);
            let globals = kernels.bind_search(&device, &self.grid_uniform, nodes);
            self.content = Some(self.content_kernels.bind(
                &device,
                (&self.grid, globals),
                (voxels, radiance),
                changed,
                (&self.tree, needs),
            ));
        }
        let Some(following) = &self.following else { return Ok(()) };
        self.has_list = true;
        kernels.run(recorder, following, needs, self.builder.as_deref());
        self.note_missed(recorder);
        self.late.record(recorder, &needs_sources(&self.state, self.builder.as_deref()));
        Ok(())
    }

    fn note_missed(&self, recorder: &mut Recorder<'_>) {
        if let Some(missed) = &self.missed {
            self.follow_kernels.note_missed(recorder, &self.missed_globals, missed);
        }
    }

    /// Applies finished read-backs; grows buffers that overflowed, with a reserve if there is
    /// dynamic surface. Returns `true` if they have grown; a list must be shown then before other
    /// calls.
    ///
    /// # Errors
    /// [`GiError::Limit`] and [`GiError::Budget`] if it does not fit.
    pub(crate) fn grow(
        &mut self,
        recorder: &mut Recorder<'_>,
        has_moving: bool,
    ) -> Result<bool, GiError> {
        let Some(words) = self.late.latest(recorder.device()) else { return Ok(false) };
        let needs = self.know(&words)?;
        self.reserve(recorder, needs, if has_moving { with_spare } else { |count| count })
    }

    /// `true` if it shows an earlier list, by the read-backs that [`Self::grow`] has applied.
    pub(crate) fn is_late(&self) -> bool {
        self.late.is_late() && self.has_list
    }

    /// Whether it shows an earlier list, by the finished read-backs; `None` before there is a list.
    /// The caller must poll the device first.
    pub(crate) fn status(&self) -> Option<Overflowed> {
        self.has_list.then(|| self.late.peek().0)
    }

    /// Frees the buffers that only partial updates need.
    pub(crate) fn trim(&mut self) {
        self.scratch = None;
        self.stop_following();
    }

    /// Applies counts that were read back.
    fn know(&mut self, words: &[u32]) -> Result<TreeNeeds, GiError> {
        let (needs, counters) = words.split_at(size_of::<TreeNeeds>() / 4);
        let needs: TreeNeeds = bytemuck::pod_read_unaligned(bytemuck::cast_slice(needs));
        if needs.overflow == 0 {
            let (groups, bricks) = (needs.groups, needs.bricks);
            let counts = match &self.builder {
                Some(builder) => builder.check(counters, groups)?,
                None => Vec::new(),
            };
            self.stats = Some(OctreeStats { groups, bricks, counts });
        }
        Ok(needs)
    }

    /// Grows the buffers to the needed size plus a reserve, and keeps their content. Returns `true`
    /// if they have grown.
    fn reserve(
        &mut self,
        recorder: &mut Recorder<'_>,
        needs: TreeNeeds,
        spare: fn(u64) -> u64,
    ) -> Result<bool, GiError> {
        let mut capacity = self.tree.capacity;
        let grown = |bit: u32, capacity: u64, needed: u32| {
            let lacks = needs.overflow & bit != 0 && capacity < needed.into();
            if lacks { spare(needed.into()) } else { capacity }
        };
        capacity.slots = 8 * grown(OVERFLOW_PLACES, capacity.slots / 8, needs.groups);
        capacity.renewals = grown(OVERFLOW_RENEWALS, capacity.renewals, needs.renewals);
        capacity.bricks = grown(OVERFLOW_BRICKS, capacity.bricks, needs.brick_places);
        if capacity == self.tree.capacity {
            return Ok(false);
        }
        let device = recorder.device().clone();
        let grid = (&self.grid, &self.layout);
        let tree = Tree::new(&device, grid, capacity, self.memory_budget)?;
        let scratch = Scratch::new(&device, &self.grid, &tree)?;
        recorder.stage("volume");
        self.resettler.copy(recorder, &self.grid_uniform, (&self.tree, &tree));
        let around = (&self.grid_uniform, &self.sampler, &self.emitters);
        self.globals = bind_globals(&device, &self.globals_layout, &tree, around);
        (self.tree, self.scratch) = (tree, Some(scratch));
        self.unbind();
        Ok(true)
    }

    pub(super) fn update(&self, recorder: &mut Recorder, changed: &ChangedCells) {
        if let Some(content) = &self.content {
            self.content_kernels.update(recorder, content, changed);
            self.note_missed(recorder);
        }
    }

    pub(super) fn globals(&self) -> &BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        let Self { tree, scratch, following, .. } = self;
        let scratch = scratch.as_ref().map_or(0, Scratch::bytes);
        let following = following.as_ref().map_or(0, BoundFollow::bytes);
        let mut memory = vec![
            ("volume: bricks", tree.atlas_bytes()),
            ("volume: places of free bricks", tree.free_runs.size()),
            ("volume: values of cells", tree.values.size()),
            ("volume: nodes and their table", tree.octree.size()),
            ("volume: places of nodes", tree.sites.size()),
            ("volume: following changes", scratch + following + self.state.bytes()),
        ];
        memory.extend(self.builder.iter().flat_map(|builder| builder.memory()));
        memory
    }

    pub(crate) fn stats(&self) -> Option<OctreeStats> {
        self.stats.clone()
    }

    /// Whether the update to the last list has overflowed.
    #[cfg(test)]
    pub(crate) fn overflows_now(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> bool {
        crate::testing::read::<TreeNeeds>(device, queue, &self.state.needs, 1)[0].overflow != 0
    }

    #[cfg(test)]
    fn tree(&self) -> (&Tree, &TreeLayout) {
        (&self.tree, &self.layout)
    }
}

/// Capacity for a count that may grow: 25 % more and a constant reserve, so that small objects do
/// not overflow when they turn.
fn with_spare(count: u64) -> u64 {
    count + count / 4 + 256
}

/// Group 0 of everything that samples the volume.
fn bind_globals(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    tree: &Tree,
    (grid_uniform, sampler, emitters): (&Buffer, &wgpu::Sampler, &Buffer),
) -> BindGroup {
    BindGroupBuilder::new(layout)
        .buffer(grid_uniform)
        .buffer(&tree.uniform)
        .buffer(&tree.octree)
        .view(&tree.atlas)
        .sampler(sampler)
        .buffer(emitters)
        .build(device, "globals")
}

/// The buffers to read back after a recording: [`TreeNeeds`], and the counters of the caller's
/// builder.
fn needs_sources<'a>(
    state: &'a State,
    builder: Option<&'a dyn OctreeBuilder>,
) -> Vec<(&'a Buffer, u64, u64)> {
    let counters = builder.and_then(|builder| builder.counters());
    let counters = counters.map(|counters| (counters, 0, counters.size()));
    let needs = (&state.needs, 0, size_of::<TreeNeeds>() as u64);
    [needs].into_iter().chain(counters).collect()
}
