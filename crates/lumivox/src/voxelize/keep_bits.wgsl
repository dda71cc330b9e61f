// Copies the bits of the voxels that stay in the moved boxes of a clipmap. Boxes move by eight
// voxels, so the 4 x 4 x 2 cells of a word stay together.

import package::cascades::is_walked;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(1) var<storage, read_write> occupancy: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word >= arrayLength(&occupancy) || old_occupancy[word] == 0u {
        return;
    }
    if !is_walked(morton_decode(32u * word)) {
        occupancy[word] |= old_occupancy[word];
    }
}
