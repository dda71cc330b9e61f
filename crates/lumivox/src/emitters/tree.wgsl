// Builds the binary tree over the emitters bottom-up: a workgroup builds the nodes of some levels
// above a part of the list.

import package::constants::{TREE_PASS_LEVELS, TREE_PASS_NODES};
import package::emitters::cluster::{cluster_of, no_cluster, pack, unite, unpack, Cluster};
import package::emitters::emitter::{emitter_of, nodes_at, tree_levels, EmitterList, Record};

struct TreePart {
    count: u32,
    // The first level of this pass.
    level: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(0) @binding(0) var<uniform> part: TreePart;
@group(0) @binding(1) var<storage, read_write> list: EmitterList;

fn first_node(level: u32) -> u32 {
    var first = part.count;
    for (var above = tree_levels(part.count); above > level; above--) {
        first += nodes_at(part.count, above);
    }
    return first;
}

fn cluster_at(level: u32, index: u32) -> Cluster {
    if index >= nodes_at(part.count, level) {
        return no_cluster();
    }
    if level == 0u {
        return cluster_of(emitter_of(list.records[index]));
    }
    let record = list.records[first_node(level) + index];
    return unite(unpack(record[0], record[1]), unpack(record[2], record[3]));
}

@compute @workgroup_size(TREE_PASS_NODES)
fn main(@builtin(workgroup_id) workgroup: vec3u, @builtin(local_invocation_index) local: u32) {
    for (var above = 0u; above < TREE_PASS_LEVELS; above++) {
        let level = part.level + above;
        let own = TREE_PASS_NODES >> above;
        let index = workgroup.x * own + local;
        if local < own && level <= tree_levels(part.count) && index < nodes_at(part.count, level) {
            let left = pack(cluster_at(level - 1u, 2u * index));
            let right = pack(cluster_at(level - 1u, 2u * index + 1u));
            list.records[first_node(level) + index] = Record(left[0], left[1], right[0], right[1]);
        }
        storageBarrier();
    }
}
