// How many values each cell of the list has; a prefix sum makes it the place of the first.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::parts::stored_parts;
import package::voxels::list::Node;

@group(1) @binding(0) var<storage, read> nodes: array<Node>;
@group(1) @binding(1) var<storage, read_write> counts: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let cell = linear_index(invocation, workgroups);
    if cell + 1u < arrayLength(&counts) {
        counts[cell] = countOneBits(stored_parts(nodes[cell].lobes));
    }
}
