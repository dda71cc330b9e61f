//! The octree: memory for the surface alone, however fine the grid.
//!
//! Nodes in groups of eight behind one child pointer; for each node and each part that it has (`../parts.wgsl`) a
//! brick of 3x3x3 texels in one 3D texture: the node's 2x2x2 cells and a layer of its neighbours', so that the
//! hardware's trilinear filter is right inside a brick (Crassin et al. 2009, "`GigaVoxels`", and 2011, section 4.1).
//! `tree.wgsl` says what is where; the folder's files follow the steps:
//!
//! | step | once per | files |
//! | --- | --- | --- |
//! | which nodes there are | voxel list | `occupy.wgsl`, `holders.wgsl` |
//! | their groups: by ranks, or by locks | voxel list | `groups.wgsl`, `build_ranked.wgsl`; `locks.wgsl`, `adopt.wgsl` |
//! | table, masks, numbers of bricks | voxel list | `table.wgsl`, `masks.wgsl`, `bricks.wgsl` |
//! | values that are still right, from the list before | voxel list | `carry.wgsl` |
//! | values of the cells, filtered level by level | light, where it has changed | `store.wgsl`, `filter.wgsl` |
//! | bricks, with the neighbours' layer | light, where it has changed | `fill*.wgsl` |
//! | look-ups | cone sample | `cells.wgsl`, `search.wgsl` |
//!
//! Everything is allocated from counts that the GPU has made, once they are known.

mod content;
mod layout;
mod locks;
#[cfg(test)]
mod tests;
mod topology;

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Pipelines, Recorder, ShaderLibrary, storage_buffer,
    uniform_buffer,
};
use crate::volume::changes::ChangedCells;
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use content::{Content, ContentKernels};
use layout::TreeLayout;
#[cfg(test)]
pub(crate) use layout::TreeUniform;
#[cfg(test)]
pub(crate) use locks::LockPass;
#[cfg(test)]
pub(crate) use tests::read_nodes;
use topology::{Topology, TopologyKernels};

/// The shader modules of this folder.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("volume::octree::adopt", include_str!("adopt.wgsl")),
    ("volume::octree::bricks", include_str!("bricks.wgsl")),
    ("volume::octree::build_ranked", include_str!("build_ranked.wgsl")),
    ("volume::octree::carry", include_str!("carry.wgsl")),
    ("volume::octree::cell_ranks", include_str!("cell_ranks.wgsl")),
    ("volume::octree::contents", include_str!("contents.wgsl")),
    ("volume::octree::count_values", include_str!("count_values.wgsl")),
    ("volume::octree::fill", include_str!("fill.wgsl")),
    ("volume::octree::fill_pointers", include_str!("fill_pointers.wgsl")),
    ("volume::octree::fill_ranked", include_str!("fill_ranked.wgsl")),
    ("volume::octree::fill_search", include_str!("fill_search.wgsl")),
    ("volume::octree::filter", include_str!("filter.wgsl")),
    ("volume::octree::groups", include_str!("groups.wgsl")),
    ("volume::octree::holders", include_str!("holders.wgsl")),
    ("volume::octree::locks", include_str!("locks.wgsl")),
    ("volume::octree::masks", include_str!("masks.wgsl")),
    ("volume::octree::neighbors", include_str!("neighbors.wgsl")),
    ("volume::octree::occupy", include_str!("occupy.wgsl")),
    ("volume::octree::ranked", include_str!("ranked.wgsl")),
    ("volume::octree::search", include_str!("search.wgsl")),
    ("volume::octree::sites", include_str!("sites.wgsl")),
    ("volume::octree::store", include_str!("store.wgsl")),
    ("volume::octree::table", include_str!("table.wgsl")),
    ("volume::octree::tree", include_str!("tree.wgsl")),
    ("volume::octree::values", include_str!("values.wgsl")),
];

/// By which power of the resolution the memory grows: as surfaces do.
const GROWTH: f64 = 2.0;

/// The look-ups into the octree: the module `package::volume::cells` of this kind of volume.
pub(crate) const CELLS: &str = include_str!("cells.wgsl");

/// How an octree is made: the defaults, and what others did, to compare. All give the same light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct OctreeOptions {
    /// How nodes come into being.
    pub builder: OctreeBuilder,
    /// How a brick's texels find the cells of the neighbours.
    pub duplication: Duplication,
    /// Over which cells the coarser levels are filtered.
    pub mipmapping: Mipmapping,
}

/// How the nodes of an octree come into being. Both builders make the same nodes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum OctreeBuilder {
    /// Numbered by ranks in bit masks: no locks, and the same order in every run.
    #[default]
    Ranks,
    /// By threads that descend together and split nodes under locks; who fails to take one comes again in the next
    /// pass (Crassin and Green 2012). Nodes lie in another order in every run, bricks do not.
    Locks,
}

/// How the texels of a brick that belong to its neighbours are found. All give the same texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Duplication {
    /// By the ranks of the voxel list: no pointers are needed.
    #[default]
    Ranks,
    /// By pointers to the next nodes along x, y and z, which take 20 bytes a node.
    Pointers,
    /// By a search from the root for each texel.
    Search,
}

/// Over which cells the coarser levels are filtered. Both give the same values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mipmapping {
    /// Over those that there are.
    #[default]
    Occupied,
    /// Over all that there could be, most of which are empty.
    Every,
}

/// What an octree is made of.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct OctreeStats {
    /// Groups of eight places for nodes, the root's included.
    pub groups: u32,
    /// Bricks of 3x3x3 texels.
    pub bricks: u32,
    /// Values of cells that the bricks are filled from.
    pub values: u32,
    /// Passes that the builder with locks took, the last of which deferred nothing; 0 with ranks.
    pub lock_passes: u32,
    /// Threads that it deferred in all passes together.
    pub deferred: u64,
}

/// The octree volume.
#[derive(Debug)]
pub(crate) struct OctreeVolume {
    grid: Grid,
    memory_budget: Option<u64>,
    globals_layout: wgpu::BindGroupLayout,
    globals: BindGroup,
    grid_uniform: Buffer,
    sampler: wgpu::Sampler,
    topology_kernels: TopologyKernels,
    content_kernels: ContentKernels,
    built: Option<Built>,
    /// Of a list that is still to be taken.
    prepared: Option<Built>,
}

/// What an octree is built from.
#[derive(Clone, Copy, Debug)]
struct Input<'a> {
    grid: &'a Grid,
    /// `Grid` of `grid.wgsl`.
    grid_uniform: &'a Buffer,
    voxels: &'a VoxelList,
    /// The most bytes that it may take.
    memory_budget: Option<u64>,
}

/// What belongs to the current voxel list.
#[derive(Debug)]
struct Built {
    topology: Topology,
    content: Content,
    /// Occupancy and ranks of the list that it was built from.
    cells: [Buffer; 2],
}

impl OctreeVolume {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &mut ShaderLibrary,
        grid: &Grid,
        options: OctreeOptions,
        memory_budget: Option<u64>,
    ) -> Result<Self, GiError> {
        let grid_uniform = grid.uniform(device);
        let globals_layout = super::globals_layout(device);
        let sampler = super::sampler(device);
        // Before there are voxels: a table without nodes.
        let layout = TreeLayout::new(grid);
        shaders.constant_u32("OCTREE_STEPS", layout.steps());
        let tree = uniform_buffer(device, "octree", &layout.uniform(1, 1));
        let octree = storage_buffer(device, "octree", layout.words(8) * 4);
        let atlas = content::atlas(device, glam::UVec3::splat(3));
        let globals = BindGroupBuilder::new(&globals_layout)
            .buffer(&grid_uniform)
            .buffer(&tree)
            .buffer(&octree)
            .view(&atlas)
            .sampler(&sampler)
            .build(device, "globals");
        Ok(Self {
            grid: *grid,
            memory_budget,
            globals_layout,
            globals,
            grid_uniform,
            sampler,
            topology_kernels: TopologyKernels::new(device, shaders, options.builder)?,
            content_kernels: ContentKernels::new(device, shaders, grid, options)?,
            built: None,
            prepared: None,
        })
    }

    /// Builds the nodes of a new list and allocates their bricks. Submits what was recorded before.
    pub(super) async fn prepare(
        &mut self,
        recorder: &mut Recorder<'_>,
        voxels: &VoxelList,
    ) -> Result<(), GiError> {
        recorder.stage("volume");
        let input = Input {
            grid: &self.grid,
            grid_uniform: &self.grid_uniform,
            voxels,
            memory_budget: self.memory_budget,
        };
        let (mut topology, order) = self.topology_kernels.build(recorder, &input).await?;
        let content = self.content_kernels.build(recorder, &input, (&mut topology, order)).await?;
        let device = recorder.device();
        let cells = [&voxels.occupancy, &voxels.ranks]
            .map(|buffer| storage_buffer(device, "cells of the octree", buffer.size()));
        self.prepared = Some(Built { topology, content, cells });
        Ok(())
    }

    /// Takes the list that was prepared for, and the light that its faces will send out: carries over the values that are
    /// still right, by the bits of cells of another surface. `changed` is the list of cells that updates will come with.
    pub(super) fn rebuild(
        &mut self,
        recorder: &mut Recorder<'_>,
        light: (&VoxelList, &Buffer),
        changed: &ChangedCells,
        bits: &Buffer,
    ) {
        let Some(mut built) = self.prepared.take() else {
            return;
        };
        recorder.stage("volume");
        let device = recorder.device().clone();
        let Built { topology, content, .. } = &mut built;
        self.content_kernels.bind(&device, &self.grid, light, (changed, bits), topology, content);
        if let Some(earlier) = &self.built {
            let old = (earlier.cells.each_ref(), &earlier.content);
            self.content_kernels.carry(recorder, &self.grid, light.0, old, content, bits);
        }
        for (from, to) in [&light.0.occupancy, &light.0.ranks].into_iter().zip(&built.cells) {
            recorder.copy((from, 0), (to, 0), from.size());
        }
        let Built { topology, content, .. } = &built;
        self.globals = BindGroupBuilder::new(&self.globals_layout)
            .buffer(&self.grid_uniform)
            .buffer(&topology.tree)
            .buffer(&topology.octree)
            .view(&content.atlas)
            .sampler(&self.sampler)
            .build(&device, "globals");
        self.built = Some(built);
    }

    pub(super) fn update(&mut self, recorder: &mut Recorder, changed: &ChangedCells) {
        if let Some(built) = &mut self.built {
            self.content_kernels.update(recorder, &mut built.content, changed);
        }
    }

    pub(super) fn globals(&self) -> &BindGroup {
        &self.globals
    }

    pub(super) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        &self.globals_layout
    }

    pub(super) fn memory(&self) -> Vec<(&'static str, u64)> {
        let Some(Built { topology, content, cells }) = &self.built else {
            return Vec::new();
        };
        vec![
            ("volume: bricks", content.atlas_bytes),
            ("volume: values of cells", content.value_bytes()),
            ("volume: nodes and their table", topology.octree.size()),
            ("volume: places of nodes", topology.sites.size()),
            ("volume: neighbours of nodes", content.neighbor_bytes()),
            ("volume: cells of the octree", cells.iter().map(|buffer| buffer.size()).sum()),
        ]
    }

    pub(super) fn stats(&self) -> Option<OctreeStats> {
        self.built.as_ref().map(|built| built.topology.stats)
    }

    #[cfg(test)]
    fn built(&self) -> &Built {
        self.built.as_ref().expect("it was built")
    }
}
