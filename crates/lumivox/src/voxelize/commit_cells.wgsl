// Commits the new list, unless it overflows: bits and ranks of all cells, and the set of voxels
// that dynamic surface touches.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::voxelize::needs::Needs;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> new_occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> new_ranks: array<u32>;
// Bits of the voxels that dynamic surface touches: now, and in the previous list.
@group(1) @binding(3) var<storage, read> moving: array<u32>;
@group(1) @binding(4) var<storage, read_write> moving_before: array<u32>;
@group(1) @binding(5) var<storage, read_write> occupancy: array<u32>;
@group(1) @binding(6) var<storage, read_write> ranks: array<u32>;
@group(1) @binding(7) var<storage, read_write> changed: array<u32>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn cells(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let word = linear_index(invocation, workgroups);
    if needs.overflow != 0u || word > arrayLength(&occupancy) {
        return;
    }
    // The last rank is the total.
    ranks[word] = new_ranks[word];
    if word == arrayLength(&occupancy) {
        return;
    }
    let former = occupancy[word];
    occupancy[word] = new_occupancy[word];
    if word < arrayLength(&moving_before) {
        // `moving` may be shorter: words beyond its end count as zero.
        var now = 0u;
        if word < arrayLength(&moving) {
            now = moving[word];
        }
        // Voxels that appear or disappear, or that dynamic surface has left; compare.wgsl finds
        // other changed voxels.
        changed[word] |= (former ^ new_occupancy[word]) | (moving_before[word] & ~now);
        moving_before[word] = now;
    }
}
