// Builds nodes from ranks: each thread handles one word of node bits and writes the groups of its
// four bytes.
//
// The eight children of a node are one byte of the node bits. A nonzero byte is a group; its number
// is the number of groups before it (groups.wgsl).

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::groups::occupied_bytes;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{node_word, tree, NODE_CHILDREN, NONE};
import package::volume::octree::needs::Needs;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> node_bits: array<u32>;
@group(1) @binding(2) var<storage, read> group_ranks: array<u32>;
@group(1) @binding(3) var<storage, read_write> octree_out: array<u32>;
@group(1) @binding(4) var<storage, read_write> sites: array<Site>;

// The group of a byte in a word of the node bits; group 0 is the root's. The byte must be nonzero.
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

fn put(slot: u32, morton: u32, level: u32) {
    sites[slot] = Site(morton, level);
    octree_out[node_word(slot) + NODE_CHILDREN] = children_of(morton, level);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if needs.overflow != 0u {
        return;
    }
    if word == 0u {
        put(0u, 0u, tree.root_level);
    }
    if word >= tree.levels[tree.root_level].x || node_bits[word] == 0u {
        return;
    }
    var level = 1u;
    while word >= tree.levels[level + 1u].x {
        level++;
    }
    let first_code = 32u * (word - tree.levels[level].x);
    for (var byte = 0u; byte < 4u; byte++) {
        let places = (node_bits[word] >> (8u * byte)) & 0xffu;
        if places == 0u {
            continue;
        }
        let first_slot = 8u * group_number(word, byte);
        for (var octant = 0u; octant < 8u; octant++) {
            if ((places >> octant) & 1u) != 0u {
                put(first_slot + octant, first_code + 8u * byte + octant, level);
            } else {
                sites[first_slot + octant] = Site(0u, 0u);
                octree_out[node_word(first_slot + octant) + NODE_CHILDREN] = NONE;
            }
        }
    }
}
