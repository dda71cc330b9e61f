// Takes over the nodes that locks.wgsl has built: those that somebody wanted, and those that lead to them.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::locks::WANTED;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{node_word, tree, NODE_CHILDREN, NONE};

@group(1) @binding(0) var<storage, read> children: array<u32>;
@group(1) @binding(1) var<storage, read> locks: array<u32>;
@group(1) @binding(2) var<storage, read_write> sites: array<Site>;
@group(1) @binding(3) var<storage, read_write> octree_out: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots {
        return;
    }
    if slot == 0u {
        sites[0] = Site(0u, tree.root_level);
    }
    octree_out[node_word(slot) + NODE_CHILDREN] = children[slot];
    if children[slot] == NONE && (locks[slot] & WANTED) == 0u {
        sites[slot].level = 0u;
    }
}
