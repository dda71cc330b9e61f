// The nodes that the cells of one level need (holders.wgsl): a bit each, in Morton order.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::holders::has_holder;
import package::volume::octree::tree::{corner_of, tree};
import package::volume::level_range::{node_range, nodes};
import package::voxels::morton::{morton_decode, morton_encode};

@group(1) @binding(2) var<storage, read_write> node_bits: array<atomic<u32>>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= node_range.count {
        return;
    }
    let cell = morton_decode(nodes[node_range.first + index].morton);
    let first_word = tree.levels[node_range.level + 1u].x;
    for (var i = 0u; i < 8u; i++) {
        if has_holder(cell, i) {
            let code = morton_encode((cell >> vec3u(1u)) - corner_of(i));
            let bit = 1u << (code % 32u);
            if (atomicLoad(&node_bits[first_word + code / 32u]) & bit) == 0u {
                atomicOr(&node_bits[first_word + code / 32u], bit);
            }
        }
    }
}
