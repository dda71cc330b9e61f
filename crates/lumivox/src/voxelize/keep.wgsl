// Copies voxels that stay in the moved boxes of a clipmap from the old static share to the new one,
// whose walks cover only the rest.

import package::cascades::is_walked;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::face_sums::FaceSlot;
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::{Node, faces_of};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_decode;

// The old share, by rank; the last value of `old_ranks` is the number of its voxels.
@group(1) @binding(0) var<storage, read> old_ranks: array<u32>;
@group(1) @binding(1) var<storage, read> old_nodes: array<Node>;
@group(1) @binding(2) var<storage, read> old_voxels: array<VoxelFaces>;
// The new share: the occupancy bits and the rank of each word of the finest level.
@group(1) @binding(3) var<storage, read> cells: array<vec2u>;
@group(1) @binding(4) var<storage, read_write> voxels: array<VoxelFaces>;
@group(1) @binding(5) var<storage, read> old_sums: array<FaceSlot>;
@group(1) @binding(6) var<storage, read_write> sums: array<FaceSlot>;

const NOTHING = 0xffffffffu;

// The new index of an old voxel; NOTHING if the voxel is not kept.
fn kept_as(old: u32) -> u32 {
    if old >= min(old_ranks[arrayLength(&old_ranks) - 1u], arrayLength(&old_voxels)) {
        return NOTHING;
    }
    let code = old_nodes[old].morton;
    if is_walked(morton_decode(code)) {
        return NOTHING;
    }
    let cell = cells[code / 32u];
    return cell.y + bits_below(cell.x, code % 32u);
}

// Copies lobes and planes, before faces are counted.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn lobes(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let old = linear_index(invocation, workgroups);
    let kept = kept_as(old);
    if kept != NOTHING {
        voxels[kept] = old_voxels[old];
    }
}

// Copies the faces' sums and scale, once faces have indices.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn faces(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let old = linear_index(invocation, workgroups);
    let kept = kept_as(old);
    if kept == NOTHING {
        return;
    }
    voxels[kept].area_low = old_voxels[old].area_low;
    let first = voxels[kept].first_face;
    let old_first = old_voxels[old].first_face;
    for (var i = 0u; i < faces_of(old_voxels[old].lobes); i++) {
        sums[first + i] = old_sums[old_first + i];
    }
}
