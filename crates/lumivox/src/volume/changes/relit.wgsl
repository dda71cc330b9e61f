// Marks voxels whose outgoing radiance differs from what the volume stores: one thread per voxel.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::counts::NodeRange;
import package::voxels::list::{Node, faces_of};

// The range of the voxels in the list.
@group(1) @binding(0) var<uniform> finest: NodeRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read> radiance: array<vec4f>;
// The radiance of each face in the volume: before this pass the stored one, afterwards that of the
// next update.
@group(1) @binding(4) var<storage, read_write> held: array<vec4f>;
@group(1) @binding(5) var<storage, read_write> changed: array<atomic<u32>>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= finest.count {
        return;
    }
    var is_same = true;
    let first = first_faces[voxel];
    let end = first + faces_of(nodes[voxel].lobes);
    for (var face = first; face < end; face++) {
        let now = radiance[face];
        // Compare bits, since the volume stores the sign of zero.
        is_same = is_same && all(bitcast<vec4u>(now) == bitcast<vec4u>(held[face]));
        held[face] = now;
    }
    let word = nodes[voxel].morton / 32u;
    let bit = 1u << (nodes[voxel].morton % 32u);
    if !is_same && (atomicLoad(&changed[word]) & bit) == 0u {
        atomicOr(&changed[word], bit);
    }
}
