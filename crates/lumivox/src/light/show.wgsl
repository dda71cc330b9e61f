// The radiance of each face that cones see.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> shown: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        shown[face] = radiance[face];
    }
}

// For cones of gathers that sample emitters.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn without_emission(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        let reflected = max(radiance[face].rgb - faces[face].emission, vec3f(0.0));
        shown[face] = vec4f(reflected, radiance[face].a);
    }
}
