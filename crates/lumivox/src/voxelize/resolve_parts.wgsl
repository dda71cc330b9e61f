// From the sums of two parts of the surface to faces: a thread per voxel.
//
// A face that both parts have is that of all pieces together: their sums, brought to the smaller of the two scales.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::world_from_grid;
import package::voxelize::face_sums::{FaceSlot, FaceSums, face_slot, is_tilted, means_of, sums_of};
import package::voxelize::resolve::ResolveParams;
import package::voxelize::unite::UnitedVoxel;
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> params: ResolveParams;
@group(1) @binding(1) var<storage, read> united: array<UnitedVoxel>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read> first_sums: array<FaceSlot>;
@group(1) @binding(4) var<storage, read> second_sums: array<FaceSlot>;
@group(1) @binding(5) var<storage, read_write> nodes: array<Node>;
@group(1) @binding(6) var<storage, read_write> faces: array<FaceSlot>;

fn sum_of(a: FaceSums, b: FaceSums) -> FaceSums {
    let scale = min(a.scale, b.scale);
    // Written out, so that a number is not scaled by a quotient that is one but for rounding.
    let of_a = select(scale / a.scale, 1.0, a.scale == scale);
    let of_b = select(scale / b.scale, 1.0, b.scale == scale);
    return FaceSums(
        scale,
        of_a * a.position + of_b * b.position,
        of_a * a.area + of_b * b.area,
        of_a * a.reflectance + of_b * b.reflectance,
        of_a * a.emission + of_b * b.emission,
    );
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= params.voxel_count {
        return;
    }
    let parts = united[voxel];
    let corner = vec3f(morton_decode(nodes[voxel].morton));
    let second_lobes = parts.lobes >> 8u;
    let all = (parts.lobes | second_lobes) & 0x3fu;
    var tilted = 0u;
    var index = first_faces[voxel];
    var lobes = all;
    while lobes != 0u {
        let lobe = countTrailingZeros(lobes);
        lobes &= lobes - 1u;
        let of_first = first_sums[parts.first_sums.x + bits_below(parts.lobes, lobe)];
        let of_second = second_sums[parts.first_sums.y + bits_below(second_lobes, lobe)];
        var sums = sums_of(of_first, parts.scales.x);
        if (second_lobes & (1u << lobe)) != 0u {
            let more = sums_of(of_second, parts.scales.y);
            if (parts.lobes & (1u << lobe)) == 0u {
                sums = more;
            } else {
                sums = sum_of(sums, more);
            }
        }
        let means = means_of(sums, lobe);
        if is_tilted(means.vector_area, lobe) {
            tilted |= 1u << lobe;
        }
        let position = world_from_grid(corner + means.position_in_voxel);
        faces[index] = face_slot(means, position, means.emission * params.emission_scale, voxel, lobe);
        index++;
    }
    nodes[voxel].lobes = all | (tilted << 8u);
}
