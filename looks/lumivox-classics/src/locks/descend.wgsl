// Builds nodes by concurrent descent: many threads split nodes at once, each under the node's lock.
//
// The first octree builders on GPUs worked like this (Crassin and Green 2012, "Octree-based sparse
// voxelization using the GPU hardware rasterizer", OpenGL Insights chapter 22). A thread creates
// one node: it descends from the root, and at a node without children it takes the node's lock,
// allocates a group of eight and descends further. If another thread has the lock, it does not
// wait: it adds itself to the list for the next pass. A lock is never released, and a node whose
// lock is taken has children at the end of the pass. So every pass brings a deferred thread down by
// at least one level, and one pass per level is enough.

import package::constants::{COUNT_BLOCK_WORDS, LINEAR_WORKGROUP_SIZE, LOCKS_DEFERRED};
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::holders::has_holder;
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{corner_of, octant_of, tree, NONE};
import package::voxels::list::Node;
import package::voxels::morton::{morton_decode, morton_encode};

struct LockPass {
    // 0 for the first pass, whose items are all pairs of a cell and one of the eight nodes that may
    // hold it.
    pass_number: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> lock_pass: LockPass;
@group(1) @binding(1) var<storage, read> nodes: array<Node>;
// For each node, the group of its children.
@group(1) @binding(2) var<storage, read_write> children: array<atomic<u32>>;
@group(1) @binding(3) var<storage, read_write> locks: array<atomic<u32>>;
@group(1) @binding(4) var<storage, read_write> sites: array<Site>;
// 0: allocated groups; 1: always zero; from 2: deferred threads of each pass.
@group(1) @binding(5) var<storage, read_write> counters: array<atomic<u32>>;
@group(1) @binding(6) var<storage, read> items: array<u32>;
@group(1) @binding(7) var<storage, read_write> deferred: array<u32>;
// The sizes of the voxel list (voxels/counts.wgsl).
@group(1) @binding(8) var<storage, read> list_counts: array<u32>;

const GROUPS: u32 = 0u;
// Bits of a lock: a thread has taken the lock; a thread wanted to create the node.
const TAKEN: u32 = 1u;
const WANTED: u32 = 2u;

struct Target {
    node_cell: vec3u,
    // 0: no target.
    level: u32,
}

fn target_of(item: u32) -> Target {
    let index = item / 8u;
    var level = 0u;
    while level + 1u < grid.levels && index >= list_counts[(level + 2u) * COUNT_BLOCK_WORDS + 1u] {
        level++;
    }
    let cell = morton_decode(nodes[index].morton);
    if !has_holder(cell, item % 8u) {
        return Target(vec3u(0u), 0u);
    }
    return Target((cell >> vec3u(1u)) - corner_of(item % 8u), level + 1u);
}

// Allocates the children of a node. Only one thread per node calls this.
fn split(node: u32, node_cell: vec3u, level: u32) -> u32 {
    let group = 1u + atomicAdd(&counters[GROUPS], 1u);
    // A tree that does not fit is discarded (needs.wgsl).
    if 8u * group >= tree.slots {
        return NONE;
    }
    for (var octant = 0u; octant < 8u; octant++) {
        sites[8u * group + octant] =
            Site(morton_encode(2u * node_cell + corner_of(octant)), level - 1u);
    }
    atomicStore(&children[node], group);
    return group;
}

// Creates nodes down to the wanted one; returns whether the wanted node exists now.
fn insert(wanted: Target) -> bool {
    var node = 0u;
    var level = tree.root_level;
    var is_stopped = false;
    while level > wanted.level && !is_stopped {
        var group = atomicLoad(&children[node]);
        if group == NONE {
            if (atomicOr(&locks[node], TAKEN) & TAKEN) == 0u {
                group = split(node, wanted.node_cell >> vec3u(level - wanted.level), level);
            }
        }
        is_stopped = group == NONE;
        level--;
        node = 8u * group + octant_of(wanted.node_cell >> vec3u(level - wanted.level));
    }
    if is_stopped {
        return false;
    }
    if (atomicLoad(&locks[node]) & WANTED) == 0u {
        atomicOr(&locks[node], WANTED);
    }
    return true;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    var item = index;
    var count = 8u * list_counts[2];
    if lock_pass.pass_number > 0u {
        count = atomicLoad(&counters[LOCKS_DEFERRED + lock_pass.pass_number - 1u]);
        if index < count {
            item = items[index];
        }
    }
    if index >= count {
        return;
    }
    let wanted = target_of(item);
    if wanted.level > 0u && !insert(wanted) {
        let place = atomicAdd(&counters[LOCKS_DEFERRED + lock_pass.pass_number], 1u);
        if place < arrayLength(&deferred) {
            deferred[place] = item;
        }
    }
}
