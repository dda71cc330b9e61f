// The renewed nodes: those with a changed cell, including removed ones.
//
// `count` writes the bit count of each word, a prefix sum turns the counts into ranks, and `list`
// writes each node to its index.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::tree::{all_parts, tree};

struct Renewal {
    // Morton code of the node's coordinates.
    morton: u32,
    level: u32,
    // 0 if the node was removed.
    is_there: u32,
    // The node's previous parts; 0 if it is new.
    old_parts: u32,
    // Masks, as in the node (tree.wgsl).
    masks: vec4u,
    // The first of the node's bricks: previous and new.
    old_first_brick: u32,
    first_brick: u32,
    padding_0: u32,
    padding_1: u32,
}

// Number of bricks that the node needs in new places: all of its bricks, or none.
fn needed_bricks(renewal: Renewal) -> u32 {
    let parts = all_parts(renewal.masks.x);
    return select(countOneBits(parts), 0u, parts == renewal.old_parts);
}

// Number of bricks that the node releases: all of its bricks, or none.
fn returned_bricks(renewal: Renewal) -> u32 {
    return select(countOneBits(renewal.old_parts), 0u, all_parts(renewal.masks.x) == renewal.old_parts);
}

// A bit per node below the root.
@group(1) @binding(0) var<storage, read> renewed: array<u32>;
// One per word of bits, and the total.
@group(1) @binding(1) var<storage, read_write> renewed_ranks: array<u32>;
@group(1) @binding(2) var<storage, read_write> renewals: array<Renewal>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word + 1u < arrayLength(&renewed_ranks) {
        renewed_ranks[word] = countOneBits(renewed[word]);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn list(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word >= tree.levels[tree.root_level].x || renewed[word] == 0u {
        return;
    }
    var level = 1u;
    while word >= tree.levels[level + 1u].x {
        level++;
    }
    let first_code = 32u * (word - tree.levels[level].x);
    var place = renewed_ranks[word];
    var bits = renewed[word];
    while bits != 0u && place < arrayLength(&renewals) {
        renewals[place].morton = first_code + countTrailingZeros(bits);
        renewals[place].level = level;
        bits &= bits - 1u;
        place++;
    }
}
