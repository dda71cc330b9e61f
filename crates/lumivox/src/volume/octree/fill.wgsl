// Fills bricks from values: each thread copies the values of one changed cell into all bricks that
// contain it (holders.wgsl).
//
// Two thirds of a brick's texels (19 of 27) are cells of neighbours.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::changes::cells::{changed_cell, level_words};
import package::volume::changes::list::NOTHING;
import package::volume::octree::holders::has_holder;
import package::volume::octree::search::{find_node, node_parts, octree};
import package::volume::octree::tree::{brick_origin, corner_of, node_word, NODE_FIRST_BRICK};
import package::volume::octree::values::{nodes, owner_at, unpack_value, value_place, values, Owner};
import package::volume::octree::needs::Needs;
import package::volume::parts::stored_parts;
import package::voxels::morton::morton_decode;

@group(1) @binding(5) var<uniform> needs: Needs;
@group(1) @binding(6) var atlas_out: texture_storage_3d<rgba16float, write>;

// The copy that a thread makes.
struct Task {
    // `false` if the thread has nothing to copy.
    exists: bool,
    cell: vec3u,
    // The level of the nodes that contain the cell.
    level: u32,
    octant: u32,
    parts: u32,
    owner: Owner,
}

fn task_of(index: u32) -> Task {
    let changed = changed_cell(index);
    if changed.node == NOTHING || needs.overflow != 0u {
        return Task(false, vec3u(0u), 0u, 0u, 0u, Owner(0u, 0u));
    }
    let level = level_words.level + 1u;
    return Task(
        true,
        morton_decode(changed.morton),
        level,
        changed.morton % 8u,
        stored_parts(nodes[changed.node].lobes),
        owner_at(changed.morton / 8u, level),
    );
}

// Copies a cell into the bricks of a node at `node_cell`.
fn fill_node(task: Task, node: u32, node_cell: vec3u) {
    let parts = node_parts(node);
    let first_brick = octree[node_word(node) + NODE_FIRST_BRICK];
    var left = task.parts & parts;
    while left != 0u {
        let part = countTrailingZeros(left);
        left &= left - 1u;
        let brick = first_brick + countOneBits(parts & ((1u << part) - 1u));
        let value = values[value_place(task.owner.first_brick, task.owner.parts, part, task.octant)];
        textureStore(atlas_out, brick_origin(brick) + task.cell - 2u * node_cell, unpack_value(value));
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let task = task_of(linear_index(invocation, workgroups));
    for (var i = 0u; i < 8u; i++) {
        if task.exists && has_holder(task.cell, i) {
            let node_cell = (task.cell >> vec3u(1u)) - corner_of(i);
            fill_node(task, find_node(node_cell, task.level), node_cell);
        }
    }
}
