//! Hook for a caller's own builder of the octree's nodes.

use std::fmt::Debug;

use crate::gpu::{BindGroup, Buffer, Pipelines, Recorder, ShaderLibrary};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

/// A way to build the nodes of an octree, instead of by ranks in bit masks.
///
/// Implement it to measure your own builder against Lumivox's, or to order the nodes for your own
/// look-ups. The set of nodes follows from the voxels (`package::volume::octree::tree` defines it),
/// and bricks are placed independently, so a builder only affects time and order: pictures stay
/// bit-identical.
pub trait OctreeBuilding: Debug + Send + Sync {
    /// The name; settings with the same builder name are equal.
    fn name(&self) -> &'static str;

    /// Creates the builder on a device.
    ///
    /// # Errors
    /// Returned by [`crate::Gi::with_pipelines`].
    fn make(&self, parts: &OctreeParts<'_>) -> Result<Box<dyn OctreeBuilder>, GiError>;
}

/// Builders are compared by their names.
impl PartialEq for dyn OctreeBuilding {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// Parts that an [`OctreeBuilding`] can use to create its [`OctreeBuilder`].
#[derive(Clone, Copy, Debug)]
pub struct OctreeParts<'a> {
    /// The device, with its pipelines.
    pub device: &'a Pipelines,
    /// All of Lumivox's modules; add your own to a clone.
    pub shaders: &'a ShaderLibrary,
    /// The grid of the voxels.
    pub grid: &'a Grid,
    /// The layout of bind group 0: `package::grid` and the uniform of
    /// `package::volume::octree::tree`.
    pub globals: &'a wgpu::BindGroupLayout,
}

/// Created by an [`OctreeBuilding`]: builds the nodes of one octree, list after list.
///
/// It must not wait for the GPU, since octrees are updated within a frame. Only the GPU knows the
/// number of nodes, and whether they fit.
pub trait OctreeBuilder: Debug + wgpu::WasmNotSendSync {
    /// Binds the list and the octree of the next builds; called when buffers of either have
    /// changed.
    ///
    /// # Errors
    /// [`GiError::Limit`] if its own buffers do not fit the device.
    fn bind(&mut self, device: &wgpu::Device, tree: &TreeToBuild<'_>) -> Result<(), GiError>;

    /// Releases the list, the octree, and all data for them; [`Self::bind`] is called before the
    /// next build.
    fn release(&mut self);

    /// Records the passes that write the nodes of the bound tree. `globals` is bind group 0
    /// ([`OctreeParts::globals`]).
    fn build(&self, recorder: &mut Recorder<'_>, globals: &BindGroup);

    /// Words that [`Self::build`] writes for the CPU; they are passed to [`Self::check`] after
    /// their read-back. The buffer must not change during the builder's lifetime, and must support
    /// being copied from ([`crate::gpu::storage_buffer`]). Default: none.
    fn counters(&self) -> Option<&Buffer> {
        None
    }

    /// Checks the words of [`Self::counters`] after a build that did not overflow, and names them
    /// for reports ([`crate::OctreeStats::counts`]). `groups` is the number of groups of nodes that
    /// had to be built, including the root's. Default: nothing to report.
    ///
    /// # Errors
    /// [`GiError::Device`] if the nodes cannot be correct.
    fn check(&self, counters: &[u32], groups: u32) -> Result<Vec<(&'static str, u64)>, GiError> {
        let _ = (counters, groups);
        Ok(Vec::new())
    }

    /// Bytes on the GPU, by content; names begin with `volume: `. Default: none.
    fn memory(&self) -> Vec<(&'static str, u64)> {
        Vec::new()
    }
}

/// Inputs and outputs of an [`OctreeBuilder`].
///
/// Nodes are stored in places, eight to a group: the children of a node are one group, and group 0
/// contains only the root, in place 0. The other groups are numbered from 1 on, in any order and
/// without gaps: a group for each node that has children. For each of the eight places of a group a
/// builder writes a site and the group of its children, also for places without a node. It writes
/// nothing on overflow.
#[derive(Clone, Copy, Debug)]
pub struct TreeToBuild<'a> {
    /// The occupied cells of all levels by their Morton codes, and their counts:
    /// `package::volume::octree::holders` defines which nodes contain a cell.
    pub voxels: &'a VoxelList,
    /// Capacity in places for nodes.
    pub places: u64,
    /// `Needs` of `package::volume::octree::needs`, as a uniform: whether everything fits
    /// (`overflow` is 0), and how many groups are needed.
    pub needs: &'a Buffer,
    /// Output: the words `node_word(place) + NODE_CHILDREN` of `package::volume::octree::tree`. The
    /// builder must not write the rest of a node.
    pub octree: &'a Buffer,
    /// Output: `array<Site>` of `package::volume::octree::sites`, one for each place.
    pub sites: &'a Buffer,
}
