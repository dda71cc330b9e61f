// From the sums of the static share to faces: a thread per voxel.

import package::cascades::grid_from_stored;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::world_from_grid;
import package::voxelize::face_sums::{FaceSlot, face_slot, is_tilted, means_of, sums_of};
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

struct ResolveParams {
    // The largest emission of all materials.
    emission_scale: f32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> params: ResolveParams;
@group(1) @binding(1) var<storage, read> voxels: array<VoxelFaces>;
@group(1) @binding(2) var<storage, read> sums: array<FaceSlot>;
@group(1) @binding(3) var<storage, read_write> nodes: array<Node>;
@group(1) @binding(4) var<storage, read_write> faces: array<FaceSlot>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= arrayLength(&voxels) {
        return;
    }
    let collected = voxels[voxel];
    let scale = bitcast<f32>(collected.area_low);
    let cell = nodes[voxel].morton;
    let stored = morton_decode(cell);
    var tilted = 0u;
    var index = collected.first_face;
    var lobes = collected.lobes;
    while lobes != 0u {
        let lobe = countTrailingZeros(lobes);
        lobes &= lobes - 1u;
        let means = means_of(sums_of(sums[index], scale, lobe));
        if is_tilted(means.vector_area, lobe) {
            tilted |= 1u << lobe;
        }
        let position = world_from_grid(grid_from_stored(stored, means.position_in_voxel));
        faces[index] = face_slot(means, position, means.emission * params.emission_scale, cell, lobe);
        index++;
    }
    nodes[voxel].lobes = collected.lobes | (tilted << 8u);
}
