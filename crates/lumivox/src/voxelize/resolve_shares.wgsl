// From the sums of both shares of the surface to the faces of the voxels that dynamic surface touches: a thread per voxel.
//
// A face that both shares have is that of all pieces together: their sums, brought to the smaller of the two scales. Where
// there is more than one layer of them, the share that lies in front in the mean hides as much of the other as it covers.

import package::cascades::grid_from_stored;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::world_from_grid;
import package::voxelize::face_sums::{FaceSlot, FaceSums, face_slot, is_tilted, means_of, sums_of};
import package::voxelize::faces::SINGLE_LAYER;
import package::voxelize::fronts::SAME_LAYER;
import package::voxelize::resolve::ResolveParams;
import package::voxelize::unite::UnitedVoxel;
import package::voxelize::verdict::Verdict;
import package::voxels::list::{Node, lobe_axis, lobe_sign};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> params: ResolveParams;
@group(1) @binding(1) var<uniform> verdict: Verdict;
@group(1) @binding(2) var<storage, read> united: array<UnitedVoxel>;
@group(1) @binding(3) var<storage, read> united_faces: array<u32>;
@group(1) @binding(4) var<storage, read> fixed_sums: array<FaceSlot>;
@group(1) @binding(5) var<storage, read> moving_sums: array<FaceSlot>;
@group(1) @binding(6) var<storage, read_write> moving_nodes: array<Node>;
@group(1) @binding(7) var<storage, read_write> moving_faces: array<FaceSlot>;

// How far in front a share lies in the mean, in voxels.
fn height_of(sums: FaceSums, lobe: u32) -> f32 {
    return lobe_sign(lobe) * sums.position[lobe_axis(lobe)] / max(sums.visible, 1.0);
}

fn sum_of(a: FaceSums, b: FaceSums, lobe: u32) -> FaceSums {
    let scale = min(a.scale, b.scale);
    // Written out, so that a number is not scaled by a quotient that is one but for rounding.
    let of_a = select(scale / a.scale, 1.0, a.scale == scale);
    let of_b = select(scale / b.scale, 1.0, b.scale == scale);
    let along = of_a * a.along + of_b * b.along;
    // What is visible of each.
    var share_a = 1.0;
    var share_b = 1.0;
    let ahead = height_of(a, lobe) - height_of(b, lobe);
    if along > SINGLE_LAYER * scale && abs(ahead) > SAME_LAYER {
        let covered = min(select(of_b * b.along, of_a * a.along, ahead > 0.0), scale);
        let hidden = select(of_a * a.along, of_b * b.along, ahead > 0.0);
        let share = min((scale - covered) / max(hidden, 1.0), 1.0);
        share_a = select(share, 1.0, ahead > 0.0);
        share_b = select(1.0, share, ahead > 0.0);
    }
    let weight_a = of_a * share_a;
    let weight_b = of_b * share_b;
    return FaceSums(
        scale,
        along,
        weight_a * a.visible + weight_b * b.visible,
        weight_a * a.position + weight_b * b.position,
        of_a * a.area + of_b * b.area,
        weight_a * a.reflectance + weight_b * b.reflectance,
        weight_a * a.emission + weight_b * b.emission,
        weight_a * a.gloss + weight_b * b.gloss,
    );
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if verdict.no_room != 0u || voxel >= verdict.moving_voxels {
        return;
    }
    let shares = united[voxel];
    let cell = moving_nodes[voxel].morton;
    let stored = morton_decode(cell);
    let second_lobes = shares.lobes >> 8u;
    let all = (shares.lobes | second_lobes) & 0x3fu;
    var tilted = 0u;
    var index = united_faces[voxel];
    var lobes = all;
    while lobes != 0u {
        let lobe = countTrailingZeros(lobes);
        lobes &= lobes - 1u;
        let of_first = fixed_sums[shares.first_sums.x + bits_below(shares.lobes, lobe)];
        let of_second = moving_sums[shares.first_sums.y + bits_below(second_lobes, lobe)];
        var sums = sums_of(of_first, shares.scales.x, lobe);
        if (second_lobes & (1u << lobe)) != 0u {
            let more = sums_of(of_second, shares.scales.y, lobe);
            if (shares.lobes & (1u << lobe)) == 0u {
                sums = more;
            } else {
                sums = sum_of(sums, more, lobe);
            }
        }
        let means = means_of(sums);
        if is_tilted(means.vector_area, lobe) {
            tilted |= 1u << lobe;
        }
        let position = world_from_grid(grid_from_stored(stored, means.position_in_voxel));
        moving_faces[index] = face_slot(means, position, means.emission * params.emission_scale, cell, lobe);
        index++;
    }
    moving_nodes[voxel].lobes = all | (tilted << 8u);
}
