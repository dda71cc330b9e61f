// Fills bricks, with neighbours found by a search from the root for each texel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::contents::own_cell;
import package::volume::octree::fill::{fill_texel, sites, texel_offset, TEXELS};
import package::volume::octree::search::find_node_from_root;
import package::volume::octree::tree::{octant_of, tree, NONE};
import package::voxels::morton::morton_decode;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    let slot = index / TEXELS;
    if slot >= tree.slots || sites[slot].level == 0u || sites[slot].level > grid.levels {
        return;
    }
    let texel = index % TEXELS;
    let offset = texel_offset(texel);
    let level = sites[slot].level;
    let owner_cell = morton_decode(sites[slot].morton) + offset / 2u;
    var owner = NONE;
    if all(owner_cell < vec3u(1u << (tree.root_level - level))) {
        owner = find_node_from_root(owner_cell, level);
    }
    let cell = own_cell(owner, octant_of(offset));
    fill_texel(slot, texel, owner != NONE && cell.x != 0u, cell.y);
}
