// Updates the bricks of renewed nodes after a change of the list. One thread per texel copies the
// cell's value if the brick is new, and writes zeros if the cell has changed, until the next light
// update.

import package::constants::{BRICK_TEXELS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::renewals::Renewal;
import package::volume::octree::search::{find_node, node_parts, octree};
import package::volume::octree::tree::{
    all_parts, brick_origin, node_word, octant_of, tree, NODE_FIRST_BRICK,
};
import package::volume::octree::values::{unpack_value, value_place};
import package::volume::octree::needs::Needs;
import package::voxels::morton::{morton_decode, morton_encode};

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> renewals: array<Renewal>;
@group(1) @binding(2) var<storage, read> changed: array<u32>;
@group(1) @binding(3) var<storage, read> values: array<vec2u>;
@group(1) @binding(4) var atlas_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let thread = linear_index(invocation, workgroups);
    if needs.overflow != 0u || thread / BRICK_TEXELS >= needs.renewals {
        return;
    }
    let renewal = renewals[thread / BRICK_TEXELS];
    let texel = thread % BRICK_TEXELS;
    let offset = vec3u(texel % 3u, (texel / 3u) % 3u, texel / 9u);
    let cell = 2u * morton_decode(renewal.morton) + offset;
    let level = renewal.level - 1u;
    let is_inside = all(cell < (grid.dimensions >> vec3u(level)));
    var is_changed = false;
    if is_inside {
        let code = morton_encode(cell);
        let word = changed[tree.levels[level].z + code / 32u];
        is_changed = ((word >> (code % 32u)) & 1u) != 0u;
    }
    let parts = all_parts(renewal.masks.x);
    let stays = parts == renewal.old_parts;
    if stays && !is_changed {
        return;
    }
    // The cell's own node, which has its values.
    var there = 0u;
    var first_brick = 0u;
    if is_inside && !is_changed {
        let owner = find_node(cell >> vec3u(1u), renewal.level);
        there = node_parts(owner);
        first_brick = octree[node_word(owner) + NODE_FIRST_BRICK];
    }
    var brick = renewal.first_brick;
    var left = parts;
    while left != 0u {
        let part = countTrailingZeros(left);
        left &= left - 1u;
        var value = vec4f(0.0);
        if ((there >> part) & 1u) != 0u {
            value = unpack_value(values[value_place(first_brick, there, part, octant_of(cell))]);
        }
        textureStore(atlas_out, brick_origin(brick) + offset, value);
        brick++;
    }
}
