// The changed cells of all levels as a list, so that passes run only over them: level by level,
// each in Morton order. `count` writes the bit count of each word, a prefix sum turns the counts
// into ranks, and `list` writes each cell to its index.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::lookup::{bits_below, level_words};

// Index of a missing cell or node.
const NOTHING = 0xffffffffu;

struct ListParams {
    // 1: skip cells that are not occupied.
    only_occupied: u32,
}

struct ChangedCell {
    morton: u32,
    // The cell's index in the list of nodes; NOTHING if it is not occupied.
    node: u32,
}

@group(1) @binding(0) var<uniform> params: ListParams;
@group(1) @binding(1) var<storage, read> occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> ranks: array<u32>;
@group(1) @binding(3) var<storage, read> changed: array<u32>;
// One per word of `changed`, and the total.
@group(1) @binding(4) var<storage, read_write> changed_ranks: array<u32>;
@group(1) @binding(5) var<storage, read_write> cells: array<ChangedCell>;

fn changed_bits(word: u32) -> u32 {
    return changed[word] & select(0xffffffffu, occupancy[word], params.only_occupied != 0u);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < arrayLength(&changed) {
        changed_ranks[word] = countOneBits(changed_bits(word));
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn list(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word >= arrayLength(&changed) {
        return;
    }
    var bits = changed_bits(word);
    if bits == 0u {
        return;
    }
    // The word's index within its level.
    var word_in_level = word;
    var level = 0u;
    while word_in_level >= level_words(level) {
        word_in_level -= level_words(level);
        level++;
    }
    let occupied = occupancy[word];
    let first_node = ranks[word];
    var rank = changed_ranks[word];
    while bits != 0u {
        let bit = countTrailingZeros(bits);
        bits &= bits - 1u;
        let is_occupied = (occupied & (1u << bit)) != 0u;
        let node = select(NOTHING, first_node + bits_below(occupied, bit), is_occupied);
        cells[rank] = ChangedCell(word_in_level * 32u + bit, node);
        rank++;
    }
}
