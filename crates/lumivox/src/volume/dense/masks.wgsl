// The parts of cells that a filtered look-up can meet, so that the tracer passes over empty space
// for one load.
//
// A trilinear look-up at level l reads 2x2x2 texels, and which ones depends only on floor(texel -
// 1/2). So each of those positions has an entry: the parts (parts.wgsl) of its 2x2x2 cells, OR-ed.
// 16 bits an entry, two in a word. Skipping by them is exact.

import package::grid::grid;

// Levels that a grid can have: 1024 voxels down to 4.
const MAX_LEVELS: u32 = 9u;

struct MaskLevels {
    // The first entry of each level, in x.
    first_entry: array<vec4u, MAX_LEVELS>,
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

// All parts that a look-up at a level can meet.
fn parts_near(position_in_grid: vec3f, level: u32) -> u32 {
    let dimensions = grid.dimensions >> vec3u(level);
    let corner = vec3i(floor(position_in_grid * exp2(-f32(level)) + 0.5));
    if any(corner < vec3i(0)) || any(corner > vec3i(dimensions)) {
        return 0u;
    }
    let entry = mask_entry(mask_levels.first_entry[level].x, vec3u(corner), dimensions);
    return (masks[entry >> 1u] >> ((entry & 1u) * 16u)) & 0xffffu;
}
