// Fills bricks. Each node that contains a cell is found by a search from the root.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::fill::{fill_node, task_of};
import package::volume::octree::holders::has_holder;
import package::volume::octree::search::find_node_from_root;
import package::volume::octree::tree::corner_of;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let task = task_of(linear_index(invocation, workgroups));
    for (var i = 0u; i < 8u; i++) {
        if task.exists && has_holder(task.cell, i) {
            let node_cell = (task.cell >> vec3u(1u)) - corner_of(i);
            fill_node(task, find_node_from_root(node_cell, task.level), node_cell);
        }
    }
}
