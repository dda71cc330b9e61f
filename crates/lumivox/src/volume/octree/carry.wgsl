// Moves the values of unchanged own cells of renewed nodes to the nodes' new bricks, and discards
// those of changed cells. One thread per cell.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::renewals::Renewal;
import package::volume::octree::tree::{all_parts, tree};
import package::volume::octree::values::value_place;
import package::volume::octree::needs::Needs;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> renewals: array<Renewal>;
// A bit per cell, laid out like the occupancy, set if the surface of the cell or of a finer cell in
// it has changed.
@group(1) @binding(2) var<storage, read> changed: array<u32>;
@group(1) @binding(3) var<storage, read_write> values: array<vec2u>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let thread = linear_index(invocation, workgroups);
    if needs.overflow != 0u || thread / 8u >= needs.renewals {
        return;
    }
    let renewal = renewals[thread / 8u];
    let octant = thread % 8u;
    let code = 8u * renewal.morton + octant;
    let word = changed[tree.levels[renewal.level - 1u].z + code / 32u];
    let is_changed = ((word >> (code % 32u)) & 1u) != 0u;
    let parts = all_parts(renewal.masks.x);
    let stays = parts == renewal.old_parts;
    if stays && !is_changed {
        return;
    }
    var left = parts;
    while left != 0u {
        let part = countTrailingZeros(left);
        left &= left - 1u;
        var value = vec2u(0u);
        if !is_changed && ((renewal.old_parts >> part) & 1u) != 0u {
            value = values[value_place(renewal.old_first_brick, renewal.old_parts, part, octant)];
        }
        values[value_place(renewal.first_brick, parts, part, octant)] = value;
    }
}
