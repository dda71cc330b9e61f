// Fills bricks, with cells found by the ranks of the voxel list.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::cell_ranks::{cell_rank, NO_CELL};
import package::volume::octree::fill::{fill_texel, sites, texel_offset, TEXELS};
import package::volume::octree::tree::tree;
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
    let cell = 2u * morton_decode(sites[slot].morton) + texel_offset(texel);
    let rank = cell_rank(cell, sites[slot].level - 1u);
    fill_texel(slot, texel, rank != NO_CELL, rank);
}
