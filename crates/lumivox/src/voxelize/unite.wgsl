// Which lobes a voxel has of each of two parts of the surface, and where the parts keep their sums.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;

struct UnitedVoxel {
    // Bits 0 to 5: lobes of the first part; bits 8 to 13: of the second.
    lobes: u32,
    padding_0: u32,
    // The index of the voxel's first face among each part's sums, and the scale of these.
    first_sums: vec2u,
    scales: vec2f,
}

@group(1) @binding(0) var<storage, read> nodes: array<Node>;
// Of each part: the occupancy bits and the rank of each word of the finest level, and its voxels.
@group(1) @binding(1) var<storage, read> first_cells: array<vec2u>;
@group(1) @binding(2) var<storage, read> first_voxels: array<VoxelFaces>;
@group(1) @binding(3) var<storage, read> second_cells: array<vec2u>;
@group(1) @binding(4) var<storage, read> second_voxels: array<VoxelFaces>;
@group(1) @binding(5) var<storage, read_write> united: array<UnitedVoxel>;
// One more than there are voxels. How many faces each has; a prefix sum makes it the index of the first one.
@group(1) @binding(6) var<storage, read_write> first_faces: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= arrayLength(&united) {
        return;
    }
    let word = nodes[voxel].morton / 32u;
    let bit = nodes[voxel].morton % 32u;
    var result: UnitedVoxel;
    let first = first_cells[word];
    if (first.x & (1u << bit)) != 0u {
        let collected = first_voxels[first.y + bits_below(first.x, bit)];
        result.lobes = collected.lobes;
        result.first_sums.x = collected.first_face;
        result.scales.x = bitcast<f32>(collected.area_low);
    }
    let second = second_cells[word];
    if (second.x & (1u << bit)) != 0u {
        let collected = second_voxels[second.y + bits_below(second.x, bit)];
        result.lobes |= collected.lobes << 8u;
        result.first_sums.y = collected.first_face;
        result.scales.y = bitcast<f32>(collected.area_low);
    }
    united[voxel] = result;
    first_faces[voxel] = countOneBits((result.lobes | (result.lobes >> 8u)) & 0x3fu);
}
