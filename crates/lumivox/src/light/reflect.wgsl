// The radiance that each face sends out: direct light plus reflected irradiance.

import package::constants::{LINEAR_WORKGROUP_SIZE, PI};
import package::gpu::dispatch::linear_index;
import package::light::reflected::reflected_from_all_around;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> direct: array<vec4f>;
@group(1) @binding(3) var<storage, read> irradiance: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> radiance: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= counts.faces {
        return;
    }
    let reflected = reflected_from_all_around(faces[index]) / PI * irradiance[index].rgb;
    radiance[index] = vec4f(direct[index].rgb + reflected, 1.0);
}
