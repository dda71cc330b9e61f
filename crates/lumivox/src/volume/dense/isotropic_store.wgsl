// Fills the changed cells of the isotropic volume's finest level from the faces of the voxel list.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::changes::cells::changed_cell;
import package::volume::changes::list::NOTHING;
import package::volume::parts::storable;
import package::voxels::list::{Face, Node, faces_of};
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var<storage, read> nodes: array<Node>;
@group(1) @binding(4) var<storage, read> first_faces: array<u32>;
@group(1) @binding(5) var<storage, read> faces: array<Face>;
@group(1) @binding(6) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(7) var cells_out: texture_storage_3d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn store(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = changed_cell(linear_index(invocation, workgroups)).node;
    if voxel == NOTHING {
        return;
    }
    // The opacity is the surface's area in the voxel, the radiance the mean over that area.
    let node = nodes[voxel];
    let first = first_faces[voxel];
    var sum = vec4f(0.0);
    for (var i = 0u; i < faces_of(node.lobes); i++) {
        let area = length(faces[first + i].vector_area);
        sum += vec4f(radiance[first + i].rgb * area, area);
    }
    if sum.a > 1.0 {
        sum /= sum.a;
    }
    textureStore(cells_out, morton_decode(node.morton), storable(sum));
}
