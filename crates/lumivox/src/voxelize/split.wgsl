// Counts the work items (tiles of columns) of each triangle, in all cascades together. A prefix sum
// turns `item_starts` into the number of each triangle's first item.

import package::cascades::box_count;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::footprint::{footprint_in, in_cascade, tile_counts};
import package::voxelize::triangles::{draws, load_triangle};

struct SplitParams {
    triangle_count: u32,
    draw_count: u32,
}

struct SplitCounts {
    // How often the counter `items` wrapped past 2^32; 0 if it is valid.
    items_overflow: atomic<u32>,
    items: atomic<u32>,
    degenerate: atomic<u32>,
    outside: atomic<u32>,
}

@group(2) @binding(0) var<uniform> params: SplitParams;
@group(2) @binding(1) var<storage, read_write> item_starts: array<u32>;
@group(2) @binding(2) var<storage, read_write> counts: SplitCounts;

// Sums of the workgroup, so that 64 triangles need only one atomic operation on memory.
var<workgroup> group_items: atomic<u32>;
var<workgroup> group_degenerate: atomic<u32>;
var<workgroup> group_outside: atomic<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let index = linear_index(invocation, workgroups);
    if index < params.triangle_count {
        let triangle = load_triangle(index, 0u, params.draw_count);
        let cascades = draws[triangle.draw].cascades;
        var items = 0u;
        var is_degenerate = false;
        for (var cascade = countTrailingZeros(cascades); cascade < box_count(); cascade++) {
            if ((cascades >> cascade) & 1u) == 0u {
                continue;
            }
            let area = footprint_in(in_cascade(triangle, cascade), cascade);
            is_degenerate = is_degenerate || area.is_degenerate;
            if !area.is_degenerate {
                let tiles = tile_counts(area);
                items += tiles.x * tiles.y;
            }
        }
        if is_degenerate {
            atomicAdd(&group_degenerate, 1u);
        } else if items == 0u {
            atomicAdd(&group_outside, 1u);
        }
        atomicAdd(&group_items, items);
        item_starts[index] = items;
    }
    workgroupBarrier();
    if local == 0u {
        let items = atomicLoad(&group_items);
        let before = atomicAdd(&counts.items, items);
        if before + items < before {
            atomicAdd(&counts.items_overflow, 1u);
        }
        let degenerate = atomicLoad(&group_degenerate);
        if degenerate > 0u {
            atomicAdd(&counts.degenerate, degenerate);
        }
        let outside = atomicLoad(&group_outside);
        if outside > 0u {
            atomicAdd(&counts.outside, outside);
        }
    }
}
