// From sums to faces: a thread per voxel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::world_from_grid;
import package::voxelize::faces::VoxelFaces;
import package::voxels::list::{Node, lobe_axis, lobe_sign};
import package::voxels::morton::morton_decode;

// Light that bounces for ever must lose some at each bounce.
const LARGEST_REFLECTANCE = 0.99;

struct ResolveParams {
    voxel_count: u32,
    // The largest emission of all materials.
    emission_scale: f32,
}

// A face before and after: sums as integers, then the numbers of voxels::list::Face as their bits. In place,
// since the two together would be the largest thing that voxelization needs.
struct FaceSlot {
    // Within the voxel at first.
    position_in_world: vec3i,
    voxel: u32,
    vector_area: vec3i,
    lobe: u32,
    reflectance: vec3i,
    padding_0: u32,
    emission: vec3i,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> params: ResolveParams;
@group(1) @binding(1) var<storage, read> voxels: array<VoxelFaces>;
@group(1) @binding(2) var<storage, read_write> nodes: array<Node>;
@group(1) @binding(3) var<storage, read_write> faces: array<FaceSlot>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= params.voxel_count {
        return;
    }
    let collected = voxels[voxel];
    let scale = bitcast<f32>(collected.area_low);
    let corner = vec3f(morton_decode(nodes[voxel].morton));
    var tilted = 0u;
    var index = collected.first_face;
    var lobes = collected.lobes;
    while lobes != 0u {
        let lobe = countTrailingZeros(lobes);
        lobes &= lobes - 1u;
        let axis = lobe_axis(lobe);

        let sums = faces[index];
        let area = vec3f(sums.vector_area);
        // The part along the lobe is the weight of the means as well. All its parts have one sign, so that it
        // is zero only where all of them are too small for the sums.
        let along = area[axis] * lobe_sign(lobe);
        let weight = max(along, 1.0);
        let vector_area = area / max(scale, along);
        let position = clamp(vec3f(sums.position_in_world) / weight, vec3f(0.0), vec3f(1.0));
        let reflectance = clamp(vec3f(sums.reflectance) / weight, vec3f(0.0), vec3f(LARGEST_REFLECTANCE));
        let emission = max(vec3f(sums.emission) / weight, vec3f(0.0)) * params.emission_scale;

        var across = vector_area;
        across[axis] = 0.0;
        // As WebGPU packs a number into 8 bits with a sign.
        if any(floor(abs(across) * 127.0 + 0.5) > vec3f(0.0)) {
            tilted |= 1u << lobe;
        }
        faces[index] = FaceSlot(
            bitcast<vec3i>(world_from_grid(corner + position)),
            voxel,
            bitcast<vec3i>(vector_area),
            lobe,
            bitcast<vec3i>(reflectance),
            0u,
            bitcast<vec3i>(emission),
            0u,
        );
        index++;
    }
    nodes[voxel].lobes = collected.lobes | (tilted << 8u);
}
