// Per-voxel data that is collected before and while faces are summed up, and the index of each
// voxel's first face in the list.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::plane_keys::is_same;
import package::voxels::list::{faces_of, with_faces};

// Areas are counted in units of 1 / AREAS_PER_UNIT of a voxel's side, rounded up, so that their sum
// is an upper bound.
const AREAS_PER_UNIT = 4096.0;

// Bound of sums: of 32 bits one is the sign, and half of the remaining range is for rounding.
const LARGEST_SUM = 1073741824.0;

struct VoxelFaces {
    // As in Node (voxels/list.wgsl); `count` adds the numbers of faces.
    lobes: u32,
    // First an upper bound of the area of all pieces in the voxel, low and high word; later the low
    // word is the factor (f32) that converts terms of sums to integers.
    area_low: u32,
    area_high: u32,
    first_face: u32,
    // Four for each lobe (planes.wgsl): the outer two are the first walk's largest key and inverted
    // smallest key; the inner two are the second walk's. Later the sorted keys of the planes, from
    // the front.
    planes: array<u32, 24>,
}

@group(1) @binding(0) var<storage, read_write> voxels: array<VoxelFaces>;
// One per voxel, and the total.
@group(1) @binding(1) var<storage, read_write> first_faces: array<u32>;
// Ranks of the finest level; the last one is the number of voxels and may exceed the capacity.
@group(1) @binding(2) var<storage, read> ranks: array<u32>;

fn voxel_count() -> u32 {
    return min(ranks[arrayLength(&ranks) - 1u], arrayLength(&voxels));
}

// Area of a voxel's pieces, in units of the area of its side.
fn area_of(voxel: u32) -> f32 {
    let low = f32(voxels[voxel].area_low);
    let high = f32(voxels[voxel].area_high) * 4294967296.0;
    return max(low + high, 1.0) / AREAS_PER_UNIT;
}

// Sorts the planes of a lobe, and counts them.
fn order_planes(voxel: u32, lobe: u32) -> u32 {
    let first = 4u * lobe;
    let front = voxels[voxel].planes[first];
    let second = voxels[voxel].planes[first + 1u];
    let third = ~voxels[voxel].planes[first + 2u];
    let back = ~voxels[voxel].planes[first + 3u];
    var count = 1u;
    if second != 0u {
        voxels[voxel].planes[first + count] = second;
        count++;
        if !is_same(second, third, lobe) {
            voxels[voxel].planes[first + count] = third;
            count++;
        }
    }
    if !is_same(front, back, lobe) {
        voxels[voxel].planes[first + count] = back;
        count++;
    }
    return count;
}

// Counts each voxel's faces: one for each plane. A prefix sum turns the counts into indices of
// first faces.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= voxel_count() {
        return;
    }
    var lobes = voxels[voxel].lobes;
    // Skips voxels that were kept from a previous share.
    if faces_of(lobes) == 0u {
        var left = lobes & 0x3fu;
        while left != 0u {
            let lobe = countTrailingZeros(left);
            left &= left - 1u;
            lobes = with_faces(lobes, lobe, order_planes(voxel, lobe));
        }
        voxels[voxel].lobes = lobes;
    }
    first_faces[voxel] = faces_of(lobes);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn prepare(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel < voxel_count() {
        // A piece's term in any sum is at most its projected area (the normal's components are at
        // most that along the dominant axis, and all other factors at most 1), so this is the
        // largest scale that cannot overflow.
        voxels[voxel].area_low = bitcast<u32>(LARGEST_SUM / area_of(voxel));
        voxels[voxel].first_face = first_faces[voxel];
    }
}
