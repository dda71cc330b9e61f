//! Options and statistics of an octree.

use crate::settings::{Choice, Choices};

/// How an octree is built: the defaults, and published alternatives for comparison. All give the
/// same light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct OctreeOptions {
    /// How a cell finds the neighbours' bricks that contain it.
    pub duplication: Duplication,
    /// Cells over which the coarser levels are filtered.
    pub mipmapping: Mipmapping,
}

/// How a cell finds the nodes before it, whose bricks contain it as a neighbour's cell. All give
/// the same texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Duplication {
    /// By a search that starts from the table of nodes, as cones do.
    #[default]
    Table,
    /// By pointers to the previous nodes along x, y and z, which need 12 bytes per node.
    Pointers,
    /// By a search from the root for each node.
    Search,
}

/// Cells over which the coarser levels are filtered. Both give the same values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Mipmapping {
    /// Only existing cells.
    #[default]
    Occupied,
    /// All possible cells, most of which are empty.
    Every,
}

impl Choices for Duplication {
    const VALUES: &'static [Self] = &[Self::Table, Self::Pointers, Self::Search];
    const CHOICES: &'static [Choice] = &[
        Choice::new("table", "by a search from the table of nodes on"),
        Choice::new("pointers", "by pointers from node to node, 12 bytes a node"),
        Choice::new("search", "by a search from the root for each"),
    ];
}

impl Choices for Mipmapping {
    const VALUES: &'static [Self] = &[Self::Occupied, Self::Every];
    const CHOICES: &'static [Choice] = &[
        Choice::new("occupied", "only occupied cells"),
        Choice::new("every", "all possible cells, most of them empty"),
    ];
}

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
