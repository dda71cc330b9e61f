// The masks of the nodes: which parts the look-ups into their bricks can meet.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::cell_ranks::{cell_rank, NO_CELL};
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{corner_of, node_word, tree, with_all_parts, NODE_MASKS};
import package::volume::parts::stored_parts;
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

@group(1) @binding(2) var<storage, read> nodes: array<Node>;
@group(1) @binding(3) var<storage, read> sites: array<Site>;
@group(1) @binding(4) var<storage, read_write> octree_out: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let slot = linear_index(invocation, workgroups);
    if slot >= tree.slots {
        return;
    }
    let site = sites[slot];
    // Above the coarsest cells nodes lead the way and have no bricks.
    if site.level == 0u || site.level > grid.levels {
        return;
    }
    let first_cell = 2u * morton_decode(site.morton);
    var masks = array<u32, 4>(0u, 0u, 0u, 0u);
    var everything = 0u;
    for (var i = 0u; i < 27u; i++) {
        let offset = vec3u(i % 3u, (i / 3u) % 3u, i / 9u);
        let rank = cell_rank(first_cell + offset, site.level - 1u);
        if rank == NO_CELL {
            continue;
        }
        let parts = stored_parts(nodes[rank].lobes);
        everything |= parts;
        // The look-ups that read this cell: those that start at it, or one before.
        for (var lookup = 0u; lookup < 8u; lookup++) {
            let from_start = offset - corner_of(lookup);
            if all(from_start <= vec3u(1u)) {
                masks[lookup / 2u] |= parts << (16u * (lookup % 2u));
            }
        }
    }
    let word = node_word(slot) + NODE_MASKS;
    octree_out[word] = with_all_parts(masks[0], everything);
    octree_out[word + 1u] = masks[1];
    octree_out[word + 2u] = masks[2];
    octree_out[word + 3u] = masks[3];
}
