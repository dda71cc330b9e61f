// The nodes of one level, for kernels that run over all of them (group 1, bindings 0 and 1).

import package::voxels::list::Node;

struct NodeRange {
    level: u32,
    first: u32,
    count: u32,
    // Only for the dense volume's masks.
    first_mask_entry: u32,
}

@group(1) @binding(0) var<uniform> node_range: NodeRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
