// Fills bricks. The nodes that contain a cell are found by pointers to the previous nodes along x,
// y and z.
//
// A node across an edge or a corner is found by following two or three of them: the nodes in
// between contain the cell as well, so they exist.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::fill::{fill_node, task_of};
import package::volume::octree::holders::has_holder;
import package::volume::octree::search::find_node;
import package::volume::octree::tree::corner_of;

// Three per node.
@group(1) @binding(7) var<storage, read> nodes_before: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let task = task_of(linear_index(invocation, workgroups));
    let own_cell = task.cell >> vec3u(1u);
    var own = 0u;
    if task.exists {
        own = find_node(own_cell, task.level);
    }
    for (var i = 0u; i < 8u; i++) {
        if task.exists && has_holder(task.cell, i) {
            let back = corner_of(i);
            var node = own;
            for (var axis = 0u; axis < 3u; axis++) {
                if back[axis] != 0u {
                    node = nodes_before[3u * node + axis];
                }
            }
            fill_node(task, node, own_cell - back);
        }
    }
}
