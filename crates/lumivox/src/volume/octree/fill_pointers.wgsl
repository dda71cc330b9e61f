// Fills bricks, with neighbours found by pointers to the next nodes along +x, +y and +z.
//
// The next node across an edge or a corner is found by two or three of them: where it holds a cell of the brick, the
// nodes on the way hold that cell as their neighbour's, so that they exist.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::volume::octree::contents::own_cell;
import package::volume::octree::fill::{fill_texel, task_of, texel_offset};
import package::volume::octree::tree::{octant_of, NONE};

// Three a node.
@group(1) @binding(1) var<storage, read> next_nodes: array<u32>;

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
    var owner = slot;
    for (var axis = 0u; axis < 3u; axis++) {
        if offset[axis] == 2u && owner != NONE {
            owner = next_nodes[3u * owner + axis];
        }
    }
    let cell = own_cell(owner, octant_of(offset));
    fill_texel(slot, task.texel, owner != NONE && cell.x != 0u, cell.y);
}
