// Second of two steps: copies the light that move_light.wgsl has saved back into the list.

import package::constants::{HAS_CELLS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::voxelize::needs::Needs;
import package::voxels::counts::ListCounts;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<uniform> counts: ListCounts;
@group(1) @binding(2) var<storage, read> moving_irradiance: array<vec4f>;
@group(1) @binding(3) var<storage, read> moving_held: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> irradiance: array<vec4f>;
@group(1) @binding(5) var<storage, read_write> held: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if needs.overflow == 0u && face < needs.moving_faces {
        irradiance[counts.fixed_faces + face] = moving_irradiance[face];
        if HAS_CELLS != 0u {
            held[counts.fixed_faces + face] = moving_held[face];
        }
    }
}
