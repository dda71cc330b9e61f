// Nodes from ranks: a thread a word of node bits writes the groups of its four bytes.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::octree::ranked::{children_of, group_number, node_bits};
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{node_word, tree, NODE_CHILDREN};

@group(1) @binding(2) var<storage, read_write> octree_out: array<u32>;
@group(1) @binding(3) var<storage, read_write> sites: array<Site>;

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
    var bits = node_bits[word];
    while bits != 0u {
        let bit = countTrailingZeros(bits);
        bits &= bits - 1u;
        put(8u * group_number(word, bit / 8u) + bit % 8u, first_code + bit, level);
    }
}
