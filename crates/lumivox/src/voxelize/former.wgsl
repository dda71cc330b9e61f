// Before a new list is committed: finds the faces that the list currently has for each voxel that
// dynamic surface touches.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::needs::Needs;
import package::voxels::list::Node;
import package::voxels::lookup::bits_below;

// Stored if the list does not contain the voxel.
const NO_FACE = 0xffffffffu;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> moving_nodes: array<Node>;
@group(1) @binding(2) var<storage, read> occupancy: array<u32>;
@group(1) @binding(3) var<storage, read> ranks: array<u32>;
@group(1) @binding(4) var<storage, read> first_faces: array<u32>;
@group(1) @binding(5) var<storage, read_write> former_faces: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if needs.overflow != 0u || voxel >= needs.moving_voxels {
        return;
    }
    let word = moving_nodes[voxel].morton / 32u;
    let bit = moving_nodes[voxel].morton % 32u;
    let bits = occupancy[word];
    var former = NO_FACE;
    if (bits & (1u << bit)) != 0u {
        former = first_faces[ranks[word] + bits_below(bits, bit)];
    }
    former_faces[voxel] = former;
}
