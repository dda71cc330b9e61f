// One level of the six-direction pyramid from the finer one, where that has changed.
//
// Along a lobe's axis the farther cell adds to the nearer one up to full coverage; across it the four columns
// are averaged. The sum saturates instead of multiplying transmittances, because coverage comes from clipping:
// the pieces of a wall that straddles two cells are parts of one sheet and add up to exactly one. What hides
// radiance hides the vector area with it, so the same weights apply to both.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::atlas::part_texel;
import package::volume::changes::cells::{changed_cell, level_words};
import package::volume::changes::list::NOTHING;
import package::volume::parts::{part_of, NEGATIVE, POSITIVE, TILT};
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var<storage, read> nodes: array<Node>;
@group(1) @binding(4) var cells_in: texture_3d<f32>;
@group(1) @binding(5) var cells_out: texture_storage_3d<rgba16float, write>;

fn load_child(cell: vec3u, axis: u32, kind: u32) -> vec4f {
    return textureLoad(cells_in, part_texel(cell, part_of(axis, kind), level_words.level - 1u), 0);
}

// The share of the farther cell that the nearer one leaves visible.
fn uncovered(near: f32, far: f32) -> f32 {
    if far <= 0.0 {
        return 0.0;
    }
    return min(far, 1.0 - near) / far;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let changed = changed_cell(linear_index(invocation, workgroups));
    if changed.node == NOTHING {
        return;
    }
    let node = nodes[changed.node];
    let cell = morton_decode(node.morton);
    for (var axis = 0u; axis < 3u; axis++) {
        if ((node.lobes >> (2u * axis)) & 3u) == 0u {
            continue;
        }
        var positive = vec4f(0.0);
        var negative = vec4f(0.0);
        var tilt = vec4f(0.0);
        for (var column = 0u; column < 4u; column++) {
            var low = 2u * cell;
            low[(axis + 1u) % 3u] += column & 1u;
            low[(axis + 2u) % 3u] += column >> 1u;
            var high = low;
            high[axis] += 1u;

            let positive_near = load_child(high, axis, POSITIVE);
            let positive_far = load_child(low, axis, POSITIVE);
            let negative_near = load_child(low, axis, NEGATIVE);
            let negative_far = load_child(high, axis, NEGATIVE);
            let tilt_low = load_child(low, axis, TILT);
            let tilt_high = load_child(high, axis, TILT);
            let positive_share = uncovered(positive_near.a, positive_far.a);
            let negative_share = uncovered(negative_near.a, negative_far.a);
            positive += positive_near + positive_share * positive_far;
            negative += negative_near + negative_share * negative_far;
            tilt += vec4f(
                tilt_high.xy + positive_share * tilt_low.xy,
                tilt_low.zw + negative_share * tilt_high.zw,
            );
        }
        textureStore(
            cells_out, part_texel(cell, part_of(axis, POSITIVE), level_words.level), 0.25 * positive);
        textureStore(
            cells_out, part_texel(cell, part_of(axis, NEGATIVE), level_words.level), 0.25 * negative);
        textureStore(cells_out, part_texel(cell, part_of(axis, TILT), level_words.level), 0.25 * tilt);
    }
}
