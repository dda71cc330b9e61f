// The arguments of dispatches over lists: of glossy tiles, a workgroup each (`glossy.wgsl`), and of
// edge pixels, an invocation each (`reconstruct.wgsl`).

import package::constants::{LINEAR_WORKGROUP_SIZE, MAX_WORKGROUPS};

// The length of the list, followed by the dispatch's workgroups.
@group(0) @binding(0) var<storage, read_write> counts: array<u32>;
@group(0) @binding(1) var<storage, read_write> listed: array<u32>;

fn set_arguments(in_workgroup: u32) {
    let count = min(counts[0], arrayLength(&listed) - 1u);
    let needed = (count + in_workgroup - 1u) / in_workgroup;
    let rows = (needed + MAX_WORKGROUPS - 1u) / MAX_WORKGROUPS;
    counts[1] = (needed + max(rows, 1u) - 1u) / max(rows, 1u);
    counts[2] = rows;
    counts[3] = select(0u, 1u, needed > 0u);
    listed[0] = count;
}

@compute @workgroup_size(1)
fn tiles() {
    set_arguments(1u);
}

@compute @workgroup_size(1)
fn pixels() {
    set_arguments(LINEAR_WORKGROUP_SIZE);
}
