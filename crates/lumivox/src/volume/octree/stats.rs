//! Statistics of an octree.

/// Statistics of an octree from the latest read-back: exact after [`crate::Gi::voxelize`], a few
/// frames late after [`crate::Gi::frame`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OctreeStats {
    /// Groups of eight places for nodes, including the root's.
    pub groups: u32,
    /// Bricks of 3x3x3 texels.
    pub bricks: u32,
    /// Counters of the caller's builder, with its names
    /// ([`OctreeBuilder::check`](super::OctreeBuilder::check)); empty with Lumivox's own.
    pub counts: Vec<(&'static str, u64)>,
}
