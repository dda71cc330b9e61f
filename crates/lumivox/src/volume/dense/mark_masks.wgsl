// Fills the masks of masks.wgsl: each occupied cell marks the eight look-up positions that read it.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::masks::{mask_entry, LOBES, TILTED_SHIFT};
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

struct LevelRange {
    level: u32,
    axis: u32,
    first_node: u32,
    node_count: u32,
    first_mask_entry: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> range: LevelRange;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
@group(1) @binding(2) var<storage, read_write> marked: array<atomic<u32>>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= range.node_count {
        return;
    }
    let node = nodes[range.first_node + index];
    let cell = morton_decode(node.morton);
    let dimensions = grid.dimensions >> vec3u(range.level);
    let bits = (node.lobes & LOBES) | (((node.lobes >> 8u) & LOBES) << TILTED_SHIFT);
    for (var corner = 0u; corner < 8u; corner++) {
        let position = cell + vec3u(corner & 1u, (corner >> 1u) & 1u, corner >> 2u);
        let entry = mask_entry(range.first_mask_entry, position, dimensions);
        atomicOr(&marked[entry >> 1u], bits << ((entry & 1u) * 16u));
    }
}
