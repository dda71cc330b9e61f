// Moves the volume's content of each face from its place in an earlier list to that in the new one,
// where a voxel's surface is the same. The other faces have changed, so their content is not
// needed.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::changes::moved::MovedParams;
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;

@group(1) @binding(0) var<uniform> params: MovedParams;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read> first_faces: array<u32>;
@group(1) @binding(3) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(4) var<storage, read> old_ranks: array<u32>;
@group(1) @binding(5) var<storage, read> old_first_faces: array<u32>;
@group(1) @binding(6) var<storage, read> old_held: array<vec4f>;
@group(1) @binding(7) var<storage, read> changed: array<u32>;
@group(1) @binding(8) var<storage, read_write> held: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if voxel >= params.voxel_count {
        return;
    }
    let word = nodes[voxel].morton / 32u;
    let bit = nodes[voxel].morton % 32u;
    if (changed[word] & (1u << bit)) != 0u {
        return;
    }
    let old_first = old_first_faces[old_ranks[word] + bits_below(old_occupancy[word], bit)];
    let first = first_faces[voxel];
    let count = first_faces[voxel + 1u] - first;
    for (var i = 0u; i < count; i++) {
        held[first + i] = old_held[old_first + i];
    }
}
