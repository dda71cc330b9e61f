// Copies the nodes that descend.wgsl has built into the octree: wanted nodes and their ancestors.

import package::classics::locks::descend::WANTED;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{node_word, tree, NODE_CHILDREN, NONE};
import package::volume::octree::needs::Needs;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> children: array<u32>;
@group(1) @binding(2) var<storage, read> locks: array<u32>;
@group(1) @binding(3) var<storage, read> locked_sites: array<Site>;
@group(1) @binding(4) var<storage, read_write> octree_out: array<u32>;
@group(1) @binding(5) var<storage, read_write> sites: array<Site>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if needs.overflow != 0u || slot >= 8u * needs.groups {
        return;
    }
    var site = locked_sites[slot];
    if children[slot] == NONE && (locks[slot] & WANTED) == 0u {
        site.level = 0u;
    }
    if slot == 0u {
        site = Site(0u, tree.root_level);
    }
    octree_out[node_word(slot) + NODE_CHILDREN] = children[slot];
    sites[slot] = site;
}
