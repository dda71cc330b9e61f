// A new list replaces the old one: marks all cells of the old list as changed.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;

@group(1) @binding(0) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(1) var<storage, read_write> changed: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < arrayLength(&old_occupancy) {
        changed[word] |= old_occupancy[word];
    }
}
