// Exclusive prefix sum (Blelloch 1990, "Prefix sums and their applications"), in place, in blocks.
//
// Each workgroup scans a block of SCAN_BLOCK elements and leaves the block's total in `totals`; the
// totals are scanned in turn, and `add` adds each block's offset to its elements. Sums wrap modulo
// 2^32.

import package::constants::{SCAN_WORKGROUP_SIZE, SCAN_ITEMS};

struct ScanParams {
    count: u32,
}

@group(0) @binding(0) var<uniform> params: ScanParams;
@group(0) @binding(1) var<storage, read_write> values: array<u32>;
@group(0) @binding(2) var<storage, read_write> totals: array<u32>;

var<workgroup> sums: array<u32, SCAN_WORKGROUP_SIZE>;

@compute @workgroup_size(SCAN_WORKGROUP_SIZE)
fn scan(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = workgroup.y * workgroups.x + workgroup.x;
    let first = (block * SCAN_WORKGROUP_SIZE + local) * SCAN_ITEMS;

    // Each invocation sums its own run of elements...
    var own: array<u32, SCAN_ITEMS>;
    var sum = 0u;
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        own[i] = sum;
        if first + i < params.count {
            sum += values[first + i];
        }
    }

    // ...the sums are scanned in shared memory, doubling the distance (Hillis and Steele 1986)...
    sums[local] = sum;
    workgroupBarrier();
    for (var distance = 1u; distance < SCAN_WORKGROUP_SIZE; distance *= 2u) {
        var before = 0u;
        if local >= distance {
            before = sums[local - distance];
        }
        workgroupBarrier();
        sums[local] += before;
        workgroupBarrier();
    }

    // ...and every element gets the sum of all before it in the block.
    let offset = sums[local] - sum;
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        if first + i < params.count {
            values[first + i] = offset + own[i];
        }
    }
    if local == SCAN_WORKGROUP_SIZE - 1u && block < arrayLength(&totals) {
        totals[block] = sums[local];
    }
}

@compute @workgroup_size(SCAN_WORKGROUP_SIZE)
fn add(
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let block = workgroup.y * workgroups.x + workgroup.x;
    if block >= arrayLength(&totals) {
        return;
    }
    let offset = totals[block];
    let first = (block * SCAN_WORKGROUP_SIZE + local) * SCAN_ITEMS;
    for (var i = 0u; i < SCAN_ITEMS; i++) {
        if first + i < params.count {
            values[first + i] += offset;
        }
    }
}
