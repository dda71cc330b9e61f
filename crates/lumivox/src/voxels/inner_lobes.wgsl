// The lobes of the inner nodes of one level: the union of those of the children. A node's children
// follow one another in the list, since the list of each level is in Morton order.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;

struct InnerParams {
    first_node: u32,
    end_node: u32,
    child_first_word: u32,
}

@group(1) @binding(0) var<uniform> params: InnerParams;
@group(1) @binding(1) var<storage, read> occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> ranks: array<u32>;
@group(1) @binding(3) var<storage, read_write> nodes: array<Node>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = params.first_node + linear_index(invocation, workgroups);
    if index >= params.end_node {
        return;
    }
    let first_child = nodes[index].morton * 8u;
    let word = params.child_first_word + first_child / 32u;
    let bits = occupancy[word];
    let first = ranks[word] + bits_below(bits, first_child % 32u);
    let children = countOneBits((bits >> (first_child % 32u)) & 0xffu);
    var lobes = 0u;
    for (var i = 0u; i < children; i++) {
        lobes |= nodes[first + i].lobes;
    }
    nodes[index].lobes = lobes;
}
