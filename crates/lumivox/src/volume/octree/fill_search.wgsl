// Fills bricks, with neighbours found by a search from the root for each texel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::volume::octree::contents::own_cell;
import package::volume::octree::fill::{fill_texel, sites, task_of, texel_offset};
import package::volume::octree::search::find_node_from_root;
import package::volume::octree::tree::{octant_of, tree, NONE};
import package::voxels::morton::morton_decode;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let task = task_of(invocation, workgroups);
    if !task.exists {
        return;
    }
    let slot = task.slot;
    let offset = texel_offset(task.texel);
    let level = sites[slot].level;
    let owner_cell = morton_decode(sites[slot].morton) + offset / 2u;
    var owner = NONE;
    if all(owner_cell < vec3u(1u << (tree.root_level - level))) {
        owner = find_node_from_root(owner_cell, level);
    }
    let cell = own_cell(owner, octant_of(offset));
    fill_texel(slot, task.texel, owner != NONE && cell.x != 0u, cell.y);
}
