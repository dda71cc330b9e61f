// The arguments of a dispatch over listed pixels (`glossy.wgsl`, `reconstruct.wgsl`).

import package::constants::{LINEAR_WORKGROUP_SIZE, MAX_WORKGROUPS};

// The number of listed pixels, followed by the dispatch's workgroups.
@group(0) @binding(0) var<storage, read_write> counts: array<u32>;
@group(0) @binding(1) var<storage, read_write> listed: array<u32>;

@compute @workgroup_size(1)
fn main() {
    let count = min(counts[0], arrayLength(&listed) - 1u);
    let needed = (count + LINEAR_WORKGROUP_SIZE - 1u) / LINEAR_WORKGROUP_SIZE;
    let rows = (needed + MAX_WORKGROUPS - 1u) / MAX_WORKGROUPS;
    counts[1] = (needed + max(rows, 1u) - 1u) / max(rows, 1u);
    counts[2] = rows;
    counts[3] = select(0u, 1u, needed > 0u);
    listed[0] = count;
}
