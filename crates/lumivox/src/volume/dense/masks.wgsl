// The parts that a filtered look-up can contain, so that the tracer skips empty space with one
// load.
//
// A trilinear look-up at level l reads 2x2x2 texels that depend only on floor(texel - 1/2). So each
// such position has an entry: the parts (parts.wgsl) of its 2x2x2 cells, OR-ed, in 16 bits; a word
// has two entries. Skipping by entries is exact.

import package::cascades::{box_size, lowest_voxel, stored_cell};
import package::constants::MASK_LEVELS;
import package::grid::grid;

struct MaskLevels {
    // The first entry of each level, in x.
    first_entry: array<vec4u, MASK_LEVELS>,
}

@group(0) @binding(1) var<uniform> mask_levels: MaskLevels;
@group(0) @binding(2) var<storage, read> masks: array<u32>;

fn mask_entry(first_entry: u32, corner: vec3u, dimensions: vec3u) -> u32 {
    let entries = dimensions + 1u;
    return first_entry + (corner.z * entries.y + corner.y) * entries.x + corner.x;
}

// The first entry of a level.
fn level_first_entry(level: u32) -> u32 {
    var first = 0u;
    for (var finer = 0u; finer < level; finer++) {
        let entries = (grid.dimensions >> vec3u(finer)) + 1u;
        first += entries.x * entries.y * entries.z;
    }
    return first;
}

// All parts that a look-up can contain, `up` levels above the voxels of the cascade. `position` is
// in these voxels. Without cascades there is one more position than cells along an axis; in a
// cascade the last position is also the first one.
fn parts_near(position: vec3f, up: u32, cascade: u32) -> u32 {
    let corner = vec3i(floor(position * exp2(-f32(up)) + 0.5));
    let from_lowest = corner - (lowest_voxel(cascade) >> vec3u(up));
    if any(from_lowest < vec3i(0)) || any(from_lowest > vec3i(box_size() >> vec3u(up))) {
        return 0u;
    }
    let stored = stored_cell(corner, up, cascade);
    let entry = mask_entry(mask_levels.first_entry[up].x, stored, grid.dimensions >> vec3u(up));
    return (masks[entry >> 1u] >> ((entry & 1u) * 16u)) & 0xffffu;
}
