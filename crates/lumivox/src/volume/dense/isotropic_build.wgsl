// Fills the isotropic volume: the finest level from the faces of the voxel list, each coarser one as the mean
// of eight cells.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::mark_masks::LevelRange;
import package::voxels::list::{Face, Node};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> range: LevelRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read> faces: array<Face>;
@group(1) @binding(4) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(5) var cells_in: texture_3d<f32>;
@group(1) @binding(6) var cells_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn store(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= range.node_count {
        return;
    }
    // The opacity is the surface's area in the voxel, the radiance the mean over it.
    let node = nodes[voxel];
    let first = first_faces[voxel];
    var sum = vec4f(0.0);
    for (var i = 0u; i < countOneBits(node.lobes & 0x3fu); i++) {
        let area = length(faces[first + i].vector_area);
        sum += vec4f(radiance[first + i].rgb * area, area);
    }
    if sum.a > 1.0 {
        sum /= sum.a;
    }
    textureStore(cells_out, morton_decode(node.morton), sum);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn average(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= range.node_count {
        return;
    }
    let cell = morton_decode(nodes[range.first_node + index].morton);
    var sum = vec4f(0.0);
    for (var child = 0u; child < 8u; child++) {
        let corner = vec3u(child & 1u, (child >> 1u) & 1u, child >> 2u);
        sum += textureLoad(cells_in, 2u * cell + corner, 0);
    }
    textureStore(cells_out, cell, 0.125 * sum);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn clear(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= range.node_count {
        return;
    }
    textureStore(cells_out, morton_decode(nodes[range.first_node + index].morton), vec4f(0.0));
}
