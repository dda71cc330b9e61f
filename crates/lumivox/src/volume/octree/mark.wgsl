// Sets the bit of each node that contains a marked cell in its bricks (holders.wgsl). Marked cells
// are the occupied ones, to find the nodes that exist, or the changed ones, to find the renewed
// nodes.
//
// The eight cells in a node are a byte of the cells' bits. Each thread handles one word of them.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::tree::{corner_of, tree};
import package::voxels::morton::{morton_decode, morton_encode};

// A bit per cell, laid out like the occupancy.
@group(1) @binding(0) var<storage, read> cell_bits: array<u32>;
// A bit per node below the root, each level in Morton order, level 1 first.
@group(1) @binding(1) var<storage, read_write> node_bits: array<atomic<u32>>;

// The cells of a node that the node minus a corner `back` contains as neighbours' cells: the first
// of two along each axis of the corner.
fn held_from(back: vec3u) -> u32 {
    return select(0xffu, 0x55u, back.x != 0u)
        & select(0xffu, 0x33u, back.y != 0u)
        & select(0xffu, 0x0fu, back.z != 0u);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word >= arrayLength(&cell_bits) || cell_bits[word] == 0u {
        return;
    }
    var level = 0u;
    while level + 1u < grid.levels && word >= tree.levels[level + 1u].z {
        level++;
    }
    let first_word = tree.levels[level + 1u].x;
    for (var byte = 0u; byte < 4u; byte++) {
        let cells = (cell_bits[word] >> (8u * byte)) & 0xffu;
        if cells == 0u {
            continue;
        }
        let own = morton_decode(4u * (word - tree.levels[level].z) + byte);
        for (var i = 0u; i < 8u; i++) {
            let back = corner_of(i);
            if (cells & held_from(back)) != 0u && all(back <= own) {
                let code = morton_encode(own - back);
                let bit = 1u << (code % 32u);
                if (atomicLoad(&node_bits[first_word + code / 32u]) & bit) == 0u {
                    atomicOr(&node_bits[first_word + code / 32u], bit);
                }
            }
        }
    }
}
