// Converts the sums of the static share to faces: a thread per voxel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::face_sums::{FaceSlot, face_of, is_tilted};
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::{Node, faces_in};

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
    let scale = bitcast<f32>(voxels[voxel].area_low);
    let cell = nodes[voxel].morton;
    let lobes = voxels[voxel].lobes;
    var tilted = 0u;
    var index = voxels[voxel].first_face;
    for (var lobe = 0u; lobe < 6u; lobe++) {
        for (var i = 0u; i < faces_in(lobes, lobe); i++) {
            let face = face_of(sums[index], scale, cell, lobes, lobe, params.emission_scale);
            tilted |= select(0u, 1u << lobe, is_tilted(bitcast<vec3f>(face.vector_area), lobe));
            faces[index] = face;
            index++;
        }
    }
    nodes[voxel].lobes = lobes | (tilted << 8u);
}
