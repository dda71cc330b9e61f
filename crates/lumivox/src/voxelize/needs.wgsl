// Decides whether everything fits; if so, writes the counts of the new list. One thread.
//
// Everything is counted even if it does not fit. Writes past the end of a buffer do no harm, since
// such a voxelization is not committed.

import package::constants::{COUNT_BLOCK_WORDS, LINEAR_WORKGROUP_SIZE, MAX_WORKGROUPS,
    OVERFLOW_FACES, OVERFLOW_NODES, OVERFLOW_SUMS, OVERFLOW_VOXELS};
import package::grid::grid;
import package::voxels::lookup::level_first_word;

// Capacities.
struct Capacity {
    voxels: u32,
    sums: u32,
    nodes: u32,
    faces: u32,
    // Faces of static surface, which come before those of voxels that dynamic surface touches.
    fixed_faces: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct Needs {
    // Bits OVERFLOW_*; the list is committed if zero.
    overflow: u32,
    // Voxels that dynamic surface touches, and the number of their faces, including those of static
    // surface.
    moving_voxels: u32,
    moving_faces: u32,
    // Needed capacities; `sums` counts only faces of dynamic surface.
    sums: u32,
    nodes: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> capacity: Capacity;
@group(1) @binding(1) var<storage, read> list_ranks: array<u32>;
// Ranks of the dynamic share; the last one is the number of its voxels.
@group(1) @binding(2) var<storage, read> moving_ranks: array<u32>;
@group(1) @binding(3) var<storage, read> own_faces: array<u32>;
@group(1) @binding(4) var<storage, read> united_faces: array<u32>;
@group(1) @binding(5) var<storage, read_write> needs: Needs;
@group(1) @binding(6) var<storage, read_write> counts: array<u32>;

fn put_groups(first: u32, threads: u32) {
    let needed = (threads + LINEAR_WORKGROUP_SIZE - 1u) / LINEAR_WORKGROUP_SIZE;
    let rows = (needed + MAX_WORKGROUPS - 1u) / MAX_WORKGROUPS;
    counts[first] = (needed + max(rows, 1u) - 1u) / max(rows, 1u);
    counts[first + 1u] = rows;
    counts[first + 2u] = select(0u, 1u, needed > 0u);
}

@compute @workgroup_size(1)
fn main() {
    let voxels = moving_ranks[arrayLength(&moving_ranks) - 1u];
    let nodes = list_ranks[level_first_word(grid.levels)];
    var now: Needs;
    now.moving_voxels = voxels;
    now.nodes = nodes;
    if voxels > capacity.voxels {
        // The number of faces is unknown.
        now.overflow |= OVERFLOW_VOXELS;
    } else {
        now.moving_faces = united_faces[voxels];
        now.sums = own_faces[voxels];
        now.overflow |= select(0u, OVERFLOW_SUMS, now.sums > capacity.sums);
        let faces = capacity.fixed_faces + now.moving_faces;
        now.overflow |= select(0u, OVERFLOW_FACES, faces > capacity.faces);
    }
    now.overflow |= select(0u, OVERFLOW_NODES, nodes > capacity.nodes);
    needs = now;
    if now.overflow != 0u {
        return;
    }
    counts[0] = capacity.fixed_faces;
    counts[1] = capacity.fixed_faces + now.moving_faces;
    counts[2] = nodes;
    counts[3] = voxels;
    put_groups(4u, counts[1]);
    for (var level = 0u; level < grid.levels; level++) {
        let first = list_ranks[level_first_word(level)];
        let count = list_ranks[level_first_word(level + 1u)] - first;
        let block = (level + 1u) * COUNT_BLOCK_WORDS;
        counts[block] = level;
        counts[block + 1u] = first;
        counts[block + 2u] = count;
        put_groups(block + 4u, count);
    }
}
