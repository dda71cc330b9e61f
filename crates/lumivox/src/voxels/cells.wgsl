// The occupancy bits of each word of level 0 and its rank, side by side: one binding instead of
// two.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;

@group(1) @binding(0) var<storage, read> occupancy: array<u32>;
@group(1) @binding(1) var<storage, read> ranks: array<u32>;
@group(1) @binding(2) var<storage, read_write> cells: array<vec2u>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < arrayLength(&cells) {
        cells[word] = vec2u(occupancy[word], ranks[word]);
    }
}
