// Fills the masks of masks.wgsl: each occupied cell adds its parts to the eight look-up positions
// that read it.

import package::cascades::stored_after;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::level_range::{node_range, nodes};
import package::volume::dense::masks::{level_first_entry, mask_entry};
import package::volume::parts::parts_of_lobes;
import package::voxels::morton::morton_decode;

@group(1) @binding(2) var<storage, read_write> marked: array<atomic<u32>>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= node_range.count {
        return;
    }
    let node = nodes[node_range.first + index];
    let cell = morton_decode(node.morton);
    let dimensions = grid.dimensions >> vec3u(node_range.level);
    let parts = parts_of_lobes(node.lobes);
    let first_entry = level_first_entry(node_range.level);
    for (var corner = 0u; corner < 8u; corner++) {
        let offset = vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let position = stored_after(cell, offset, node_range.level);
        let entry = mask_entry(first_entry, position, dimensions);
        atomicOr(&marked[entry >> 1u], parts << ((entry & 1u) * 16u));
    }
}
