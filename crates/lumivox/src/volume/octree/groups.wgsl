// Numbers the groups of nodes by ranks: without locks, in the same order in every run.
//
// The eight children of a node are one byte of the node bits. A nonzero byte is a group; its number
// is the number of groups before it, by a prefix sum over the words' counts.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::tree::tree;

// The bits of the nodes below the root's level, level 1 first.
@group(1) @binding(0) var<storage, read> node_bits: array<u32>;
// One per word of bits, and the total.
@group(1) @binding(1) var<storage, read_write> group_ranks: array<u32>;

// The lowest bit of each byte is set if any bit of the byte is.
fn occupied_bytes(word: u32) -> u32 {
    var bytes = word | (word >> 4u);
    bytes |= bytes >> 2u;
    bytes |= bytes >> 1u;
    return bytes & 0x01010101u;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn count(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if word < tree.levels[tree.root_level].x {
        group_ranks[word] = countOneBits(occupied_bytes(node_bits[word]));
    }
}
