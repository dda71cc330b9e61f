// Computes the masks of renewed nodes (the parts that look-ups into their bricks can contain), and
// counts needed and released runs of bricks by length.

import package::constants::{CELL_PARTS, LINEAR_WORKGROUP_SIZE, RUN_KINDS};
import package::gpu::dispatch::linear_index;
import package::volume::octree::cell_ranks::{cell_rank, NO_CELL};
import package::volume::octree::renewals::{needed_bricks, returned_bricks, Renewal};
import package::volume::octree::search::{find_node, node_parts, octree};
import package::volume::octree::tree::{corner_of, node_word, tree, with_all_parts, NODE_FIRST_BRICK};
import package::volume::parts::stored_parts;
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

@group(1) @binding(2) var<storage, read> nodes: array<Node>;
// A bit per existing node below the root.
@group(1) @binding(3) var<storage, read> node_bits: array<u32>;
@group(1) @binding(4) var<storage, read> renewed_ranks: array<u32>;
@group(1) @binding(5) var<storage, read_write> renewals: array<Renewal>;
// For each kind of run, the number of runs of each workgroup; then the total. Kinds are the lengths
// 1 to 9 of needed runs, then of released runs.
@group(1) @binding(6) var<storage, read_write> run_starts: array<u32>;

var<workgroup> runs: array<atomic<u32>, RUN_KINDS>;

fn masks_of(node_cell: vec3u, level: u32) -> vec4u {
    var masks = vec4u(0u);
    var everything = 0u;
    for (var i = 0u; i < 27u; i++) {
        let offset = vec3u(i % 3u, (i / 3u) % 3u, i / 9u);
        let rank = cell_rank(2u * node_cell + offset, level - 1u);
        if rank == NO_CELL {
            continue;
        }
        let parts = stored_parts(nodes[rank].lobes);
        everything |= parts;
        // Look-ups that start at this cell or one cell before read it.
        for (var lookup = 0u; lookup < 8u; lookup++) {
            if all(offset - corner_of(lookup) <= vec3u(1u)) {
                masks[lookup / 2u] |= parts << (16u * (lookup % 2u));
            }
        }
    }
    masks.x = with_all_parts(masks.x, everything);
    return masks;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_index(invocation, workgroups);
    let count = min(renewed_ranks[arrayLength(&renewed_ranks) - 1u], arrayLength(&renewals));
    if index < count {
        var renewal = renewals[index];
        let node_cell = morton_decode(renewal.morton);
        let word = node_bits[tree.levels[renewal.level].x + renewal.morton / 32u];
        renewal.is_there = (word >> (renewal.morton % 32u)) & 1u;
        renewal.masks = vec4u(0u);
        if renewal.is_there != 0u {
            renewal.masks = masks_of(node_cell, renewal.level);
        }
        let old = find_node(node_cell, renewal.level);
        renewal.old_parts = node_parts(old);
        renewal.old_first_brick = octree[node_word(old) + NODE_FIRST_BRICK];
        renewals[index] = renewal;
        let needed = needed_bricks(renewal);
        if needed > 0u {
            atomicAdd(&runs[needed - 1u], 1u);
        }
        let returned = returned_bricks(renewal);
        if returned > 0u {
            atomicAdd(&runs[CELL_PARTS + returned - 1u], 1u);
        }
    }
    workgroupBarrier();
    let blocks = (arrayLength(&run_starts) - 1u) / RUN_KINDS;
    let block = index / LINEAR_WORKGROUP_SIZE;
    if local < RUN_KINDS && block < blocks {
        run_starts[local * blocks + block] = atomicLoad(&runs[local]);
    }
}
