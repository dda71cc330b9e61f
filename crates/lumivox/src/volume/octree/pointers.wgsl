// Pointers from each node to the previous ones along x, y and z (fill_pointers.wgsl).

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::search::find_node;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::NONE;
import package::volume::octree::needs::Needs;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> sites: array<Site>;
@group(1) @binding(2) var<storage, read_write> nodes_before: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if needs.overflow != 0u || slot >= 8u * needs.groups {
        return;
    }
    let site = sites[slot];
    if site.level == 0u || site.level > grid.levels {
        return;
    }
    let node_cell = morton_decode(site.morton);
    for (var axis = 0u; axis < 3u; axis++) {
        var before = NONE;
        if node_cell[axis] > 0u {
            var cell = node_cell;
            cell[axis] -= 1u;
            before = find_node(cell, site.level);
        }
        nodes_before[3u * slot + axis] = before;
    }
}
