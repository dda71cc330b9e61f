// Finds the lobes of each share in a voxel that dynamic surface touches, and where the shares store
// their sums.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::{MOST_FACES, Node, faces_in, faces_of, with_faces};
import package::voxels::lookup::bits_below;

struct UnitedVoxel {
    // Lobes, as in Node: of both shares together, and of each one.
    lobes: u32,
    fixed_lobes: u32,
    moving_lobes: u32,
    padding: u32,
    // The index of the voxel's first face among each share's sums, and the scale of those sums.
    first_sums: vec2u,
    scales: vec2f,
}

// All lobes of two shares, with the faces of both.
fn united_lobes(fixed: u32, moving: u32) -> u32 {
    var lobes = (fixed | moving) & 0x3fu;
    for (var lobe = 0u; lobe < 6u; lobe++) {
        lobes = with_faces(lobes, lobe, min(faces_in(fixed, lobe) + faces_in(moving, lobe), MOST_FACES));
    }
    return lobes;
}

// The static share: the occupancy bits and the rank of each word of the finest level, and its
// voxels.
@group(1) @binding(0) var<storage, read> fixed_cells: array<vec2u>;
@group(1) @binding(1) var<storage, read> fixed_voxels: array<VoxelFaces>;
// The dynamic share, by rank; the last value of `moving_ranks` is the number of its voxels.
@group(1) @binding(2) var<storage, read> moving_ranks: array<u32>;
@group(1) @binding(3) var<storage, read> moving_nodes: array<Node>;
@group(1) @binding(4) var<storage, read> moving_voxels: array<VoxelFaces>;
@group(1) @binding(5) var<storage, read_write> united: array<UnitedVoxel>;
// Number of faces of each voxel, and a last element. A prefix sum turns it into indices of first
// faces and the total.
@group(1) @binding(6) var<storage, read_write> united_faces: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    let count = min(moving_ranks[arrayLength(&moving_ranks) - 1u], arrayLength(&united));
    if voxel >= count {
        return;
    }
    let word = moving_nodes[voxel].morton / 32u;
    let bit = moving_nodes[voxel].morton % 32u;
    var result: UnitedVoxel;
    // A missing share has no cells.
    if word < arrayLength(&fixed_cells) {
        let fixed = fixed_cells[word];
        if (fixed.x & (1u << bit)) != 0u {
            let own = fixed.y + bits_below(fixed.x, bit);
            result.fixed_lobes = fixed_voxels[own].lobes;
            result.first_sums.x = fixed_voxels[own].first_face;
            result.scales.x = bitcast<f32>(fixed_voxels[own].area_low);
        }
    }
    result.moving_lobes = moving_voxels[voxel].lobes;
    result.first_sums.y = moving_voxels[voxel].first_face;
    result.scales.y = bitcast<f32>(moving_voxels[voxel].area_low);
    result.lobes = united_lobes(result.fixed_lobes, result.moving_lobes);
    united[voxel] = result;
    united_faces[voxel] = faces_of(result.lobes);
}
