// What each voxel collects before and while its faces are summed up, and where its faces stand in the list.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;

// Areas are counted in this unit, rounded up, so that their sum is an upper bound.
const AREAS_PER_UNIT = 4096.0;

// Sums stay below this; the sign needs one bit of 32, and rounding half of the rest.
const LARGEST_SUM = 1073741824.0;

struct VoxelFaces {
    // A bit per lobe that has a piece of surface.
    lobes: u32,
    // First an upper bound of the area of all pieces in the voxel, low and high word; then, in place of the
    // low word, the factor (f32) that turns a share of a sum into an integer.
    area_low: u32,
    area_high: u32,
    first_face: u32,
}

@group(1) @binding(0) var<storage, read_write> voxels: array<VoxelFaces>;
// One more than there are voxels: the total.
@group(1) @binding(1) var<storage, read_write> first_faces: array<u32>;

// How many faces each voxel has. A prefix sum makes it the index of the first one.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel < arrayLength(&voxels) {
        first_faces[voxel] = countOneBits(voxels[voxel].lobes);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn prepare(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel < arrayLength(&voxels) {
        // A piece's part of any sum is at most its projected area (the normal's components are at most that
        // along the dominant axis, and all other factors at most 1): as large a scale as the sum allows.
        let low = f32(voxels[voxel].area_low);
        let high = f32(voxels[voxel].area_high) * 4294967296.0;
        let area = max(low + high, 1.0) / AREAS_PER_UNIT;
        voxels[voxel].area_low = bitcast<u32>(LARGEST_SUM / area);
        voxels[voxel].first_face = first_faces[voxel];
    }
}
