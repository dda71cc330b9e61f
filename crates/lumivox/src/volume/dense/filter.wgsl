// One level of the six-direction pyramid from the finer one, for the two lobes of one axis.
//
// Along the axis the farther cell adds to the nearer one up to full coverage; across it the four columns are
// averaged. The sum saturates instead of multiplying transmittances, because coverage comes from clipping:
// the pieces of a wall that straddles two cells are parts of one sheet and add up to exactly one. What hides
// radiance hides the vector area with it, so the same weights apply to both.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::mark_masks::LevelRange;
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> range: LevelRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var positive_in: texture_3d<f32>;
@group(1) @binding(3) var negative_in: texture_3d<f32>;
@group(1) @binding(4) var tilt_in: texture_3d<f32>;
@group(1) @binding(5) var positive_out: texture_storage_3d<rgba16float, write>;
@group(1) @binding(6) var negative_out: texture_storage_3d<rgba16float, write>;
@group(1) @binding(7) var tilt_out: texture_storage_3d<rgba8snorm, write>;

// The share of the farther cell that the nearer one leaves visible.
fn uncovered(near: f32, far: f32) -> f32 {
    if far <= 0.0 {
        return 0.0;
    }
    return min(far, 1.0 - near) / far;
}

// The children of a column: `low` has the smaller coordinate along the axis.
fn column_low(cell: vec3u, column: u32) -> vec3u {
    var low = 2u * cell;
    low[(range.axis + 1u) % 3u] += column & 1u;
    low[(range.axis + 2u) % 3u] += column >> 1u;
    return low;
}

fn column_high(low: vec3u) -> vec3u {
    var high = low;
    high[range.axis] += 1u;
    return high;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn filter_radiance(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= range.node_count {
        return;
    }
    let node = nodes[range.first_node + index];
    let lobes = (node.lobes >> (2u * range.axis)) & 3u;
    if lobes == 0u {
        return;
    }
    let cell = morton_decode(node.morton);
    var positive = vec4f(0.0);
    var negative = vec4f(0.0);
    for (var column = 0u; column < 4u; column++) {
        let low = column_low(cell, column);
        let high = column_high(low);
        if (lobes & 1u) != 0u {
            let near = textureLoad(positive_in, high, 0);
            let far = textureLoad(positive_in, low, 0);
            positive += near + uncovered(near.a, far.a) * far;
        }
        if (lobes & 2u) != 0u {
            let near = textureLoad(negative_in, low, 0);
            let far = textureLoad(negative_in, high, 0);
            negative += near + uncovered(near.a, far.a) * far;
        }
    }
    textureStore(positive_out, cell, 0.25 * positive);
    textureStore(negative_out, cell, 0.25 * negative);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn filter_tilt(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= range.node_count {
        return;
    }
    let node = nodes[range.first_node + index];
    if ((node.lobes >> (8u + 2u * range.axis)) & 3u) == 0u {
        return;
    }
    let cell = morton_decode(node.morton);
    var tilt = vec4f(0.0);
    for (var column = 0u; column < 4u; column++) {
        let low = column_low(cell, column);
        let high = column_high(low);
        let tilt_low = textureLoad(tilt_in, low, 0);
        let tilt_high = textureLoad(tilt_in, high, 0);
        let positive_far =
            uncovered(textureLoad(positive_in, high, 0).a, textureLoad(positive_in, low, 0).a);
        let negative_far =
            uncovered(textureLoad(negative_in, low, 0).a, textureLoad(negative_in, high, 0).a);
        tilt += vec4f(
            tilt_high.xy + positive_far * tilt_low.xy,
            tilt_low.zw + negative_far * tilt_high.zw,
        );
    }
    textureStore(tilt_out, cell, 0.25 * tilt);
}
