//! The nodes of one level, as kernels run over them.

use bytemuck::{Pod, Zeroable};

use crate::voxels::VoxelList;

/// `NodeRange` of `level_range.wgsl`: the nodes of a level.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct NodeRange {
    pub(crate) level: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) first_mask_entry: u32,
}

impl NodeRange {
    pub(super) fn new(voxels: &VoxelList, level: u32) -> Self {
        let nodes = voxels.level_nodes(level);
        Self { level, first: nodes.start, count: nodes.len() as u32, first_mask_entry: 0 }
    }
}
