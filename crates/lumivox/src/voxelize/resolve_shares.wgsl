// Converts the sums of both shares of the surface to the faces of the voxels that dynamic surface
// touches: a thread per voxel. A lobe has the faces of both shares, the static ones first.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::face_sums::{FaceSlot, face_of, is_tilted};
import package::voxelize::resolve::ResolveParams;
import package::voxelize::unite::UnitedVoxel;
import package::voxelize::needs::Needs;
import package::voxels::list::{Node, faces_before, faces_in};

@group(1) @binding(0) var<uniform> params: ResolveParams;
@group(1) @binding(1) var<uniform> needs: Needs;
@group(1) @binding(2) var<storage, read> united: array<UnitedVoxel>;
@group(1) @binding(3) var<storage, read> united_faces: array<u32>;
@group(1) @binding(4) var<storage, read> fixed_sums: array<FaceSlot>;
@group(1) @binding(5) var<storage, read> moving_sums: array<FaceSlot>;
@group(1) @binding(6) var<storage, read_write> moving_nodes: array<Node>;
@group(1) @binding(7) var<storage, read_write> moving_faces: array<FaceSlot>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if needs.overflow != 0u || voxel >= needs.moving_voxels {
        return;
    }
    let shares = united[voxel];
    let cell = moving_nodes[voxel].morton;
    var tilted = 0u;
    var index = united_faces[voxel];
    for (var lobe = 0u; lobe < 6u; lobe++) {
        let fixed = faces_in(shares.fixed_lobes, lobe);
        let first_fixed = shares.first_sums.x + faces_before(shares.fixed_lobes, lobe);
        let first_moving = shares.first_sums.y + faces_before(shares.moving_lobes, lobe);
        for (var i = 0u; i < faces_in(shares.lobes, lobe); i++) {
            let is_fixed = i < fixed;
            var sums: FaceSlot;
            if is_fixed {
                sums = fixed_sums[first_fixed + i];
            } else {
                sums = moving_sums[first_moving + i - fixed];
            }
            let scale = select(shares.scales.y, shares.scales.x, is_fixed);
            let face = face_of(sums, scale, cell, shares.lobes, lobe, params.emission_scale);
            tilted |= select(0u, 1u << lobe, is_tilted(bitcast<vec3f>(face.vector_area), lobe));
            moving_faces[index] = face;
            index++;
        }
    }
    moving_nodes[voxel].lobes = shares.lobes | (tilted << 8u);
}
