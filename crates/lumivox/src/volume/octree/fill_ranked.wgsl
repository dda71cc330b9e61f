// Fills bricks, with cells found by the ranks of the voxel list.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::volume::octree::cell_ranks::{cell_rank, NO_CELL};
import package::volume::octree::fill::{fill_texel, sites, task_of, texel_offset};
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
    let cell = 2u * morton_decode(sites[slot].morton) + texel_offset(task.texel);
    let rank = cell_rank(cell, sites[slot].level - 1u);
    fill_texel(slot, task.texel, rank != NO_CELL, rank);
}
