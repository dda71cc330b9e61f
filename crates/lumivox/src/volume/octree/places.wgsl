// Assigns places to the bricks of renewed nodes.
//
// A node with unchanged parts keeps its bricks in place. Others get free runs of exactly the needed
// length, the last released one first, or else runs after all bricks. Both are assigned in the
// order of ranks, so that a sequence of lists leads to the same places whenever it is repeated.

import package::constants::{CELL_PARTS, LINEAR_WORKGROUP_SIZE, RUN_KINDS};
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::renewals::{needed_bricks, returned_bricks, Renewal};
import package::volume::octree::tree::{table_entry, tree};
import package::volume::octree::needs::Needs;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> run_starts: array<u32>;
@group(1) @binding(2) var<storage, read_write> renewals: array<Renewal>;
// The first bricks of free runs: a stack for each length.
@group(1) @binding(3) var<storage, read_write> free_runs: array<u32>;
@group(1) @binding(4) var<storage, read_write> octree_out: array<u32>;

// The run length of each thread of the workgroup.
var<workgroup> lengths: array<u32, LINEAR_WORKGROUP_SIZE>;

// The start of the stack of a length. A stack has space for as many runs as fit the atlas.
fn stack_start(length: u32) -> u32 {
    var start = 0u;
    for (var shorter = 1u; shorter < length; shorter++) {
        start += tree.bricks / shorter;
    }
    return start;
}

fn free_before(length: u32) -> u32 {
    return needs.free[length / 4u][length % 4u];
}

// Number of runs of a kind in the workgroups before this one.
fn runs_before(kind: u32, block: u32) -> u32 {
    let blocks = (arrayLength(&run_starts) - 1u) / RUN_KINDS;
    return run_starts[kind * blocks + block] - run_starts[kind * blocks];
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn take(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_index(invocation, workgroups);
    let is_renewed = index < needs.renewals;
    var length = 0u;
    if is_renewed {
        length = needed_bricks(renewals[index]);
    }
    lengths[local] = length;
    workgroupBarrier();
    if !is_renewed {
        return;
    }
    if length == 0u {
        renewals[index].first_brick = renewals[index].old_first_brick;
        return;
    }
    // Runs assigned to the nodes before this one.
    var before: array<u32, 10>;
    for (var i = 1u; i <= CELL_PARTS; i++) {
        before[i] = runs_before(i - 1u, index / LINEAR_WORKGROUP_SIZE);
    }
    for (var i = 0u; i < local; i++) {
        before[lengths[i]] += 1u;
    }
    if before[length] < free_before(length) {
        let place = stack_start(length) + free_before(length) - 1u - before[length];
        renewals[index].first_brick = free_runs[place];
        return;
    }
    var first = needs.first_place;
    for (var i = 1u; i <= CELL_PARTS; i++) {
        first += i * (before[i] - min(before[i], free_before(i)));
    }
    renewals[index].first_brick = first;
}

// Releases runs after all runs are assigned, and removes removed nodes from the table.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn give_back(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_index(invocation, workgroups);
    let is_renewed = index < needs.renewals;
    var length = 0u;
    if is_renewed {
        length = returned_bricks(renewals[index]);
    }
    lengths[local] = length;
    workgroupBarrier();
    if !is_renewed {
        return;
    }
    let renewal = renewals[index];
    if renewal.is_there == 0u && renewal.level >= tree.table_level {
        octree_out[table_entry(morton_decode(renewal.morton), renewal.level)] = 0u;
    }
    if length == 0u {
        return;
    }
    var before = runs_before(CELL_PARTS + length - 1u, index / LINEAR_WORKGROUP_SIZE);
    for (var i = 0u; i < local; i++) {
        before += select(0u, 1u, lengths[i] == length);
    }
    let free = free_before(length);
    let left = free - min(free, needs.needed[length / 4u][length % 4u]);
    free_runs[stack_start(length) + left + before] = renewal.old_first_brick;
}
