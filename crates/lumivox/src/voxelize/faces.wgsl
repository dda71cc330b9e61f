// What each voxel collects before and while its faces are summed up, and where its faces stand in the list.

import package::constants::{FACE_WORDS, FRONT_WORDS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;

// Areas are counted in this unit, rounded up, so that their sum is an upper bound.
const AREAS_PER_UNIT = 4096.0;

// Sums stay below this; the sign needs one bit of 32, and rounding half of the rest.
const LARGEST_SUM = 1073741824.0;

// More surface than this in a voxel, in areas of its side, and one layer may hide another: a plane has at most 1.
// What is above 1 is for the rounding up of the pieces.
const SINGLE_LAYER = 1.0 + 1.0 / 32.0;

// Instead of the place of a voxel's fronts: it has none.
const NO_FRONTS = 0xffffffffu;

struct VoxelFaces {
    // A bit per lobe that has a piece of surface.
    lobes: u32,
    // First an upper bound of the area of all pieces in the voxel, low and high word; then, in their place, the
    // factor (f32) that turns a share of a sum into an integer, and the first word of its faces' fronts
    // (fronts.wgsl) behind the sums, or NO_FRONTS.
    area_low: u32,
    area_high: u32,
    first_face: u32,
}

@group(1) @binding(0) var<storage, read_write> voxels: array<VoxelFaces>;
// One more than there are voxels: the total.
@group(1) @binding(1) var<storage, read_write> first_faces: array<u32>;
// As `first_faces`, of the faces that have fronts.
@group(1) @binding(2) var<storage, read_write> first_fronts: array<u32>;
// Of the finest level; the last one is the number of voxels, for all of which there may be no room.
@group(1) @binding(3) var<storage, read> ranks: array<u32>;

fn voxel_count() -> u32 {
    return min(ranks[arrayLength(&ranks) - 1u], arrayLength(&voxels));
}

// In areas of a voxel's side.
fn area_of(faces: VoxelFaces) -> f32 {
    let low = f32(faces.area_low);
    let high = f32(faces.area_high) * 4294967296.0;
    return max(low + high, 1.0) / AREAS_PER_UNIT;
}

// How many faces each voxel has, and how many of them with fronts. Prefix sums make these the index of the first one.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel < voxel_count() {
        let count = countOneBits(voxels[voxel].lobes);
        first_faces[voxel] = count;
        first_fronts[voxel] = select(0u, count, area_of(voxels[voxel]) > SINGLE_LAYER);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn prepare(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel < voxel_count() {
        // A piece's part of any sum is at most its projected area (the normal's components are at most that
        // along the dominant axis, and all other factors at most 1): as large a scale as the sum allows.
        let area = area_of(voxels[voxel]);
        let faces = first_faces[voxel_count()];
        let fronts = faces * FACE_WORDS + first_fronts[voxel] * FRONT_WORDS;
        voxels[voxel].area_low = bitcast<u32>(LARGEST_SUM / area);
        voxels[voxel].area_high = select(NO_FRONTS, fronts, area > SINGLE_LAYER);
        voxels[voxel].first_face = first_faces[voxel];
    }
}
