// The number of a group, from the ranks of groups.wgsl.

import package::volume::octree::groups::occupied_bytes;
import package::volume::octree::tree::{tree, NONE};

@group(1) @binding(0) var<storage, read> node_bits: array<u32>;
@group(1) @binding(1) var<storage, read> group_ranks: array<u32>;

// The group of a byte of a word of the node bits; group 0 is the root's. The byte must not be zero.
fn group_number(word: u32, byte: u32) -> u32 {
    let before = occupied_bytes(node_bits[word]) & ((1u << (8u * byte)) - 1u);
    return 1u + group_ranks[word] + countOneBits(before);
}

// The group of the children of a node.
fn children_of(morton: u32, level: u32) -> u32 {
    if level < 2u {
        return NONE;
    }
    let word = tree.levels[level - 1u].x + morton / 4u;
    let byte = morton % 4u;
    if ((node_bits[word] >> (8u * byte)) & 0xffu) == 0u {
        return NONE;
    }
    return group_number(word, byte);
}

// Where a node stands, if nodes stand in the order of ranks.
fn ranked_slot(morton: u32, level: u32) -> u32 {
    if level == tree.root_level {
        return 0u;
    }
    let code = morton / 8u;
    return 8u * group_number(tree.levels[level].x + code / 4u, code % 4u) + morton % 8u;
}
