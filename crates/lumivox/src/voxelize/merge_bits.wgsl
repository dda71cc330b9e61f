// The union of the voxels of both shares of the surface. A missing share has no voxels.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;

@group(1) @binding(0) var<storage, read> first: array<u32>;
@group(1) @binding(1) var<storage, read> second: array<u32>;
@group(1) @binding(2) var<storage, read_write> merged: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    let words = max(arrayLength(&first), arrayLength(&second));
    if word >= words {
        return;
    }
    var bits = 0u;
    if word < arrayLength(&first) {
        bits |= first[word];
    }
    if word < arrayLength(&second) {
        bits |= second[word];
    }
    merged[word] = bits;
}
