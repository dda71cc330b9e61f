//! The hook for a caller's own way to build the octree's nodes.

use std::fmt::Debug;

use crate::gpu::{BindGroup, Buffer, Pipelines, Recorder, ShaderLibrary};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

/// How the nodes of an octree come into being, instead of by ranks in bit masks.
///
/// Write one to measure a builder of your own against Lumivox's, or to give nodes the order that your own look-ups like
/// best. Which nodes there are follows from the voxels (`package::volume::octree::tree` defines it), and bricks have
/// places of their own, so a builder decides about time and order alone: pictures keep their bits.
pub trait OctreeBuilding: Debug + Send + Sync {
    /// The name; settings that name the same builder are equal.
    fn name(&self) -> &'static str;

    /// Makes what builds on a device.
    ///
    /// # Errors
    /// As [`crate::Gi::with_pipelines`], which passes them on.
    fn make(&self, parts: &OctreeParts<'_>) -> Result<Box<dyn OctreeBuilder>, GiError>;
}

/// Builders are compared by their names.
impl PartialEq for dyn OctreeBuilding {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// What an [`OctreeBuilding`] can be made of.
#[derive(Clone, Copy, Debug)]
pub struct OctreeParts<'a> {
    /// The device, with its pipelines.
    pub device: &'a Pipelines,
    /// All of Lumivox's modules; add your own to a clone.
    pub shaders: &'a ShaderLibrary,
    /// Where the voxels are.
    pub grid: &'a Grid,
    /// The layout of bind group 0: `package::grid` and the uniform of `package::volume::octree::tree`.
    pub globals: &'a wgpu::BindGroupLayout,
}

/// What an [`OctreeBuilding`] makes: it builds the nodes of one octree, list after list.
///
/// Nothing of it may wait for the GPU, since octrees follow voxels that move within a frame. How many nodes there are is
/// known on the GPU alone, and so is whether there is room for them.
pub trait OctreeBuilder: Debug + wgpu::WasmNotSendSync {
    /// Takes the list and the octree that the next builds are for; called when either has other buffers.
    ///
    /// # Errors
    /// [`GiError::Limit`] when what it needs for them does not fit the device.
    fn bind(&mut self, device: &wgpu::Device, tree: &TreeToBuild<'_>) -> Result<(), GiError>;

    /// Lets go of the list and the octree, and of what it keeps for them: nothing will be built before the next
    /// [`Self::bind`].
    fn release(&mut self);

    /// Records the passes that write the nodes of what is bound. `globals` is bind group 0 ([`OctreeParts::globals`]).
    fn build(&self, recorder: &mut Recorder<'_>, globals: &BindGroup);

    /// Words that [`Self::build`] writes for the CPU, to be given to [`Self::check`] once they have arrived. It is the
    /// same buffer as long as the builder lives, and can be copied from ([`crate::gpu::storage_buffer`]). Default: none.
    fn counters(&self) -> Option<&Buffer> {
        None
    }

    /// Checks the words of [`Self::counters`] after a build for which there was room, and gives them names for reports
    /// ([`crate::OctreeStats::counts`]). `groups` is how many groups of nodes had to be built, the root's included.
    /// Default: nothing to report.
    ///
    /// # Errors
    /// [`GiError::Device`] when the nodes cannot be right.
    fn check(&self, counters: &[u32], groups: u32) -> Result<Vec<(&'static str, u64)>, GiError> {
        let _ = (counters, groups);
        Ok(Vec::new())
    }

    /// Bytes on the GPU, by what they hold; names begin with `volume: `. Default: none.
    fn memory(&self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }
}

/// What an [`OctreeBuilder`] reads, and where it writes nodes to.
///
/// Nodes stand in places, eight to a group: the children of a node are one group, and group 0 has the root alone, in
/// place 0. The other groups are numbered from 1 on, in any order and without a gap: a group for each node that has
/// children. For each of the eight places of a group a builder writes a site and the group of its children, for places
/// without a node as well. It writes nothing if there is no room.
#[derive(Clone, Copy, Debug)]
pub struct TreeToBuild<'a> {
    /// The occupied cells of all levels by their Morton codes, and their counts: `package::volume::octree::holders` tells
    /// which nodes hold a cell.
    pub voxels: &'a VoxelList,
    /// Places for nodes that there is room for.
    pub places: u64,
    /// `Verdict` of `package::volume::octree::verdict`, as a uniform: whether there is room (`no_room` is 0), and how many
    /// groups are needed.
    pub verdict: &'a Buffer,
    /// To be written: the words `node_word(place) + NODE_CHILDREN` of `package::volume::octree::tree`. The rest of a node is
    /// not the builder's.
    pub octree: &'a Buffer,
    /// To be written: `array<Site>` of `package::volume::octree::sites`, one for each place.
    pub sites: &'a Buffer,
}
