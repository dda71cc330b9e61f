//! How an octree is made, and what it is made of.

/// How an octree is made: the defaults, and what others did, to compare. All give the same light.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct OctreeOptions {
    /// How a cell finds the bricks of its neighbours that hold it.
    pub duplication: Duplication,
    /// Over which cells the coarser levels are filtered.
    pub mipmapping: Mipmapping,
}

/// How a cell finds the nodes before it, whose bricks hold it as their neighbour's. All give the same texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Duplication {
    /// By a search from the table of nodes on, as cones do.
    #[default]
    Table,
    /// By pointers to the nodes before along x, y and z, which take 12 bytes a node.
    Pointers,
    /// By a search from the root for each.
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

/// What an octree is made of, as far as the GPU has told: exactly after [`crate::Gi::voxelize`], a few frames late after
/// [`crate::Gi::voxelize_frame`].
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct OctreeStats {
    /// Groups of eight places for nodes, the root's included.
    pub groups: u32,
    /// Bricks of 3x3x3 texels.
    pub bricks: u32,
    /// What the caller's builder has counted, by its names ([`OctreeBuilder::check`](super::OctreeBuilder::check)); empty with Lumivox's own.
    pub counts: Vec<(&'static str, u64)>,
}
