// The voxels of an earlier list that a new one does not have: the first kind of change.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::changes::moved::MovedParams;

@group(1) @binding(0) var<uniform> params: MovedParams;
@group(1) @binding(1) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> occupancy: array<u32>;
@group(1) @binding(3) var<storage, read_write> changed: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < params.finest_words {
        let old = old_occupancy[word];
        changed[word] = select(old & ~occupancy[word], old | occupancy[word], params.all != 0u);
    }
}
