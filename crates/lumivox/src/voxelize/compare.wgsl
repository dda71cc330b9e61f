// Marks voxels touched by dynamic surface as changed if their surface differs from the list's.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::former::NO_FACE;
import package::voxelize::needs::Needs;
import package::voxels::list::{Face, Node};

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> moving_nodes: array<Node>;
@group(1) @binding(2) var<storage, read> united_faces: array<u32>;
@group(1) @binding(3) var<storage, read> moving_faces: array<Face>;
@group(1) @binding(4) var<storage, read> former_faces: array<u32>;
@group(1) @binding(5) var<storage, read> faces: array<Face>;
// A bit per cell of the finest level.
@group(1) @binding(6) var<storage, read_write> changed: array<atomic<u32>>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if needs.overflow != 0u || voxel >= needs.moving_voxels {
        return;
    }
    let cell = moving_nodes[voxel].morton;
    let first = united_faces[voxel];
    let count = united_faces[voxel + 1u] - first;
    let former = former_faces[voxel];
    var is_same = former != NO_FACE;
    for (var i = 0u; is_same && i < count; i++) {
        let before = faces[former + i];
        let now = moving_faces[first + i];
        // Compares bits, since the volume also stores the sign of a zero.
        is_same = before.cell == cell && before.lobe == now.lobe
            && all(bitcast<vec3u>(before.vector_area) == bitcast<vec3u>(now.vector_area))
            && all(bitcast<vec3u>(before.position_in_world) == bitcast<vec3u>(now.position_in_world));
    }
    // The voxel may have had more faces.
    if is_same && former + count < arrayLength(&faces) {
        is_same = faces[former + count].cell != cell;
    }
    if !is_same {
        atomicOr(&changed[cell / 32u], 1u << (cell % 32u));
    }
}
