// The voxels whose changes the octree missed while it overflowed. They are applied once it has
// grown.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::needs::Needs;

@group(1) @binding(0) var<uniform> needs: Needs;
// A bit per voxel.
@group(1) @binding(1) var<storage, read_write> missed: array<u32>;
// A bit per cell of all levels, the voxels first.
@group(1) @binding(2) var<storage, read_write> changed: array<u32>;

// Runs before an update to a list: marks missed changes as changed.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn join(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < arrayLength(&missed) {
        changed[word] |= missed[word];
    }
}

// Runs after `needs.wgsl`, and after an update of light: marks changes as missed on overflow,
// otherwise clears the marks.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn note(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < arrayLength(&missed) {
        missed[word] = select(0u, missed[word] | changed[word], needs.overflow != 0u);
    }
}
