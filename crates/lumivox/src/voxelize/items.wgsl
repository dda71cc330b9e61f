// Converts a work item's number to its triangle and tile.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;

// The triangles of one dispatch: those of neighbouring draws that share their textures.
struct ItemRun {
    first_triangle: u32,
    end_triangle: u32,
    first_draw: u32,
    end_draw: u32,
}

@group(2) @binding(0) var<storage, read> item_starts: array<u32>;
@group(3) @binding(0) var<uniform> run: ItemRun;

struct Item {
    exists: bool,
    triangle: u32,
    // The tile's number within its triangle: the tiles of the finest cascade come first.
    tile: u32,
}

var<workgroup> first_and_last: array<u32, 2>;

// The last triangle in [first, end) whose items start at or before `item`. A triangle without items
// starts where the next one does, so it is never found.
fn find_triangle(item: u32, first: u32, end: u32) -> u32 {
    var low = first;
    var high = end;
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if item_starts[middle] <= item {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

// All invocations of a workgroup must call this. Two of them find the first and last triangle of
// the workgroup; then each searches only between these two.
fn find_item(invocation: vec3u, workgroups: vec3u, local: u32) -> Item {
    let end_item = item_starts[run.end_triangle];
    let item = item_starts[run.first_triangle] + linear_index(invocation, workgroups);
    if local < 2u {
        let sought = min(item - local + local * (LINEAR_WORKGROUP_SIZE - 1u), end_item - 1u);
        first_and_last[local] = find_triangle(sought, run.first_triangle, run.end_triangle);
    }
    workgroupBarrier();
    if item >= end_item {
        return Item(false, 0u, 0u);
    }
    let triangle = find_triangle(item, first_and_last[0], first_and_last[1] + 1u);
    return Item(true, triangle, item - item_starts[triangle]);
}
