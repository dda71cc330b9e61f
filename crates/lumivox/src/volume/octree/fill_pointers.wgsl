// Fills bricks, with neighbours found by pointers to the next nodes along +x, +y and +z.
//
// The next node across an edge or a corner is found by two or three of them: where it holds a cell of the brick, the
// nodes on the way hold that cell as their neighbour's, so that they exist.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::contents::own_cell;
import package::volume::octree::fill::{fill_texel, sites, texel_offset, TEXELS};
import package::volume::octree::tree::{octant_of, tree, NONE};

// Three a node.
@group(1) @binding(1) var<storage, read> next_nodes: array<u32>;

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
    var owner = slot;
    for (var axis = 0u; axis < 3u; axis++) {
        if offset[axis] == 2u && owner != NONE {
            owner = next_nodes[3u * owner + axis];
        }
    }
    let cell = own_cell(owner, octant_of(offset));
    fill_texel(slot, texel, owner != NONE && cell.x != 0u, cell.y);
}
