// Copies the faces of the voxels that dynamic surface touches into the list, after those of static
// surface.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::needs::Needs;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<uniform> counts: ListCounts;
@group(1) @binding(2) var<storage, read> moving_faces: array<Face>;
@group(1) @binding(3) var<storage, read_write> faces: array<Face>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if needs.overflow == 0u && face < needs.moving_faces {
        faces[counts.fixed_faces + face] = moving_faces[face];
    }
}
