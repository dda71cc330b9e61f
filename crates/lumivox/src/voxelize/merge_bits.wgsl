// The cells that any of two parts of the surface touches. The bits of all levels are one array, and a coarser
// level is an OR of the finer one, so that the parts' pyramids make that of the whole.

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
    if word < arrayLength(&merged) {
        merged[word] = first[word] | second[word];
    }
}
