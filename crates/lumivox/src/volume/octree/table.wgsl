// Fills the table that searches start from: the nodes of its level and of all coarser ones.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{table_entry, tree};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<storage, read> sites: array<Site>;
@group(1) @binding(1) var<storage, read_write> octree_out: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots {
        return;
    }
    let site = sites[slot];
    if site.level >= tree.table_level && site.level < tree.root_level {
        octree_out[table_entry(morton_decode(site.morton), site.level)] = slot;
    }
}
