// Values that are still right, from the octree of the list before: those of cells in which nothing has changed.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::tree::tree;
import package::volume::level_range::{node_range, nodes};
import package::voxels::lookup::bits_below;

// A bit per cell, laid out as the occupancy: cells of another surface, here or below.
@group(1) @binding(2) var<storage, read> changed: array<u32>;
@group(1) @binding(3) var<storage, read> value_starts: array<u32>;
@group(1) @binding(4) var<storage, read_write> values: array<vec2u>;
@group(1) @binding(5) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(6) var<storage, read> old_ranks: array<u32>;
@group(1) @binding(7) var<storage, read> old_starts: array<u32>;
@group(1) @binding(8) var<storage, read> old_values: array<vec2u>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= node_range.count {
        return;
    }
    let cell = node_range.first + index;
    let code = nodes[cell].morton;
    let word = tree.levels[node_range.level].z + code / 32u;
    let bit = 1u << (code % 32u);
    if (changed[word] & bit) != 0u || (old_occupancy[word] & bit) == 0u {
        return;
    }
    // The same surface has the same parts.
    let old_cell = old_ranks[word] + bits_below(old_occupancy[word], code % 32u);
    let first = value_starts[cell];
    let count = value_starts[cell + 1u] - first;
    for (var i = 0u; i < count; i++) {
        values[first + i] = old_values[old_starts[old_cell] + i];
    }
}
