// Which lobes a voxel that dynamic surface touches has of each share of the surface, and where the shares keep their sums.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;

struct UnitedVoxel {
    // Bits 0 to 5: lobes of the static share; bits 8 to 13: of the dynamic one.
    lobes: u32,
    padding_0: u32,
    // The index of the voxel's first face among each share's sums, and the scale of these.
    first_sums: vec2u,
    scales: vec2f,
}

// Of the static share: the occupancy bits and the rank of each word of the finest level, and its voxels.
@group(1) @binding(0) var<storage, read> fixed_cells: array<vec2u>;
@group(1) @binding(1) var<storage, read> fixed_voxels: array<VoxelFaces>;
// Of the dynamic share, by rank; the last one of `moving_ranks` is their number.
@group(1) @binding(2) var<storage, read> moving_ranks: array<u32>;
@group(1) @binding(3) var<storage, read> moving_nodes: array<Node>;
@group(1) @binding(4) var<storage, read> moving_voxels: array<VoxelFaces>;
@group(1) @binding(5) var<storage, read_write> united: array<UnitedVoxel>;
// One more than there are voxels. How many faces each has; a prefix sum makes it the index of the first one.
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
    // A share that is not there has no cells.
    if word < arrayLength(&fixed_cells) {
        let fixed = fixed_cells[word];
        if (fixed.x & (1u << bit)) != 0u {
            let collected = fixed_voxels[fixed.y + bits_below(fixed.x, bit)];
            result.lobes = collected.lobes;
            result.first_sums.x = collected.first_face;
            result.scales.x = bitcast<f32>(collected.area_low);
        }
    }
    let collected = moving_voxels[voxel];
    result.lobes |= collected.lobes << 8u;
    result.first_sums.y = collected.first_face;
    result.scales.y = bitcast<f32>(collected.area_low);
    united[voxel] = result;
    united_faces[voxel] = countOneBits((result.lobes | (result.lobes >> 8u)) & 0x3fu);
}
