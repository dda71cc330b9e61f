// The lobes of the inner nodes of one level: the union of those of the children. A node's children
// are consecutive in the list, since the list of each level is in Morton order.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::counts::NodeRange;
import package::voxels::list::Node;
import package::voxels::lookup::{bits_below, level_first_word};

@group(1) @binding(0) var<uniform> range: NodeRange;
@group(1) @binding(1) var<storage, read> occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> ranks: array<u32>;
@group(1) @binding(3) var<storage, read_write> nodes: array<Node>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let place = linear_index(invocation, workgroups);
    if place >= range.count {
        return;
    }
    let index = range.first + place;
    let first_child = nodes[index].morton * 8u;
    let word = level_first_word(range.level - 1u) + first_child / 32u;
    let bits = occupancy[word];
    let first = ranks[word] + bits_below(bits, first_child % 32u);
    let children = countOneBits((bits >> (first_child % 32u)) & 0xffu);
    var lobes = 0u;
    for (var i = 0u; i < children; i++) {
        lobes |= nodes[first + i].lobes & 0x3fffu;
    }
    nodes[index].lobes = lobes;
}
