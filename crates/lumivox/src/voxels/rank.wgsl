// The compact list from the occupancy bits: `count` writes the bit count of each word, a prefix sum
// turns the counts into ranks, and `list` writes each set bit's Morton code to its place in the
// list, without its lobes.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxels::list::Node;
import package::voxels::lookup::level_words;

@group(1) @binding(0) var<storage, read> occupancy: array<u32>;
// One per word of `occupancy`, and the total.
@group(1) @binding(1) var<storage, read_write> ranks: array<u32>;
@group(1) @binding(2) var<storage, read_write> nodes: array<Node>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word >= arrayLength(&occupancy) {
        return;
    }
    ranks[word] = countOneBits(occupancy[word]);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn list(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word >= arrayLength(&occupancy) {
        return;
    }
    var bits = occupancy[word];
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
    var rank = ranks[word];
    while bits != 0u {
        let bit = countTrailingZeros(bits);
        nodes[rank].morton = word_in_level * 32u + bit;
        rank++;
        bits &= bits - 1u;
    }
}
