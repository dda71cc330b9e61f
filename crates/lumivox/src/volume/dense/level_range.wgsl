// The nodes of one level: what the kernels that fill the volume run over (group 1, bindings 0 and 1).

import package::voxels::list::Node;

struct NodeRange {
    level: u32,
    first: u32,
    count: u32,
    first_mask_entry: u32,
    // Of the level's bits.
    first_word: u32,
}

@group(1) @binding(0) var<uniform> node_range: NodeRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
