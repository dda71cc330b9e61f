// One bounce: faces gather the radiance of other faces. Reflectance is below one, so repeated
// bounces converge. Later gathers after a change are accelerated by the heavy-ball method (Polyak
// 1964).

import package::cascades::cascade_of;
import package::constants::{
    GROWTH_OF_MOMENTUM, LINEAR_WORKGROUP_SIZE, MOMENTUM, MOST_MOMENTUM, RELAXATION,
};
import package::gpu::dispatch::linear_index;
import package::light::turn::{
    counts, face_in_turn, faces, first_fresh, from_emitters, irradiance, is_fresh, keep_last_step,
    last_step, settings,
};
import package::light::gather_method::gathered_at;
import package::voxels::morton::morton_decode;

// The irradiance after a gather that found `sum`: it goes beyond the sum, and continues a share of
// the last step, which grows from the fifth gather on. A channel whose change reverses its sign
// takes the sum itself. Otherwise light between two walls closer than a voxel would diverge.
fn relaxed(index: u32, before: vec4f, sum: vec3f) -> vec3f {
    let change = sum - before.rgb;
    let last = last_step(index);
    let momentum = min(MOMENTUM + GROWTH_OF_MOMENTUM * max(before.w - 3.0, 0.0), MOST_MOMENTUM);
    let step = select(RELAXATION * change + momentum * last, change, change * last < vec3f(0.0));
    return max(before.rgb + step, vec3f(0.0));
}

fn gather_at(index: u32) {
    let face = faces[index];
    let level = cascade_of(morton_decode(face.cell));
    var sum = gathered_at(index, face, level);
    if settings.has_emitters != 0u {
        sum += from_emitters(index);
    }
    let before = irradiance[index];
    var gathers = 1.0;
    if settings.relaxes != 0u && before.w != 0.0 {
        gathers += before.w;
        sum = relaxed(index, before, sum);
        keep_last_step(index, sum - before.rgb);
    } else {
        keep_last_step(index, vec3f(0.0));
    }
    irradiance[index] = vec4f(sum, gathers);
}

// The faces whose turn it is.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = face_in_turn(linear_index(invocation, workgroups));
    if index < counts.faces {
        gather_at(index);
    }
}

// Faces that have never gathered and do not gather in this turn: of a new list, or of voxels that
// dynamic surface touches.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn fresh(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = first_fresh() + linear_index(invocation, workgroups);
    if is_fresh(index) {
        gather_at(index);
    }
}
