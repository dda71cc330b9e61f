// The nodes of one level, for kernels that run over all of them (group 1, bindings 0 and 1).

import package::voxels::counts::NodeRange;
import package::voxels::list::Node;

@group(1) @binding(0) var<uniform> node_range: NodeRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
