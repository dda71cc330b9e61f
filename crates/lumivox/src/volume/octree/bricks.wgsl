// Numbering the bricks: a node has one for each of its parts.
//
// Numbers follow the order of ranks whatever order the nodes themselves are in: the threads of a builder with locks
// come in any order, and where a brick stands in the atlas must not depend on it, down to the last bit of a filtered
// look-up.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::ranked::ranked_slot;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{all_parts, node_word, tree, NODE_FIRST_BRICK, NODE_MASKS};

@group(1) @binding(2) var<storage, read> sites: array<Site>;
@group(1) @binding(3) var<storage, read_write> octree_out: array<u32>;
// By rank; one more than there are slots: the total.
@group(1) @binding(4) var<storage, read_write> brick_starts: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots || sites[slot].level == 0u {
        return;
    }
    let parts = all_parts(octree_out[node_word(slot) + NODE_MASKS]);
    brick_starts[ranked_slot(sites[slot].morton, sites[slot].level)] = countOneBits(parts);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn assign(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots || sites[slot].level == 0u {
        return;
    }
    octree_out[node_word(slot) + NODE_FIRST_BRICK] =
        brick_starts[ranked_slot(sites[slot].morton, sites[slot].level)];
}
