// Turns the lengths of runs of work items into arguments of indirect dispatches.
//
// One dimension allows 65535 workgroups, so the workgroups of a long run are distributed over x and
// y as in Kernel::dispatch_linear; the shader finds its item with gpu::dispatch::linear_index.

import package::constants::{LINEAR_WORKGROUP_SIZE, MAX_WORKGROUPS};
import package::gpu::dispatch::linear_index;

// The bounds of a run, as indices into `item_starts`.
struct Run {
    first: u32,
    end: u32,
}

// Exclusive prefix sum of the items.
@group(0) @binding(0) var<storage, read> item_starts: array<u32>;
@group(0) @binding(1) var<storage, read> runs: array<Run>;
// Three words per run.
@group(0) @binding(2) var<storage, read_write> arguments: array<u32>;
// Nonzero if there are too many items to number; then nothing is dispatched.
@group(0) @binding(3) var<storage, read> overflow: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&runs) {
        return;
    }
    let run = runs[index];
    var items = item_starts[run.end] - item_starts[run.first];
    if overflow[0] != 0u {
        items = 0u;
    }
    let needed = (items + LINEAR_WORKGROUP_SIZE - 1u) / LINEAR_WORKGROUP_SIZE;
    let rows = (needed + MAX_WORKGROUPS - 1u) / MAX_WORKGROUPS;
    let columns = (needed + max(rows, 1u) - 1u) / max(rows, 1u);
    arguments[3u * index] = columns;
    arguments[3u * index + 1u] = rows;
    arguments[3u * index + 2u] = select(0u, 1u, needed > 0u);
}
