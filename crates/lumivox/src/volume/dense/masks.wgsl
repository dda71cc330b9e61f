// Which lobes a filtered look-up can meet: what lets the tracer pass over empty space at the price of one load.
//
// A trilinear look-up at level l reads 2x2x2 texels, and which ones depends only on floor(texel - 1/2). So each
// of those positions has an entry: the lobes of its 2x2x2 cells, OR-ed. 16 bits an entry, two in a word: bits
// 0 to 5 the lobes that are there, bits 6 to 11 those of them that are tilted. Skipping by them is exact.

import package::grid::grid;

const LOBES: u32 = 0x3fu;
const TILTED_SHIFT: u32 = 6u;
// Levels that a grid can have: 1024 voxels down to 4.
const MAX_LEVELS: u32 = 9u;

struct MaskLevels {
    // The first entry of each level.
    first_entry: array<vec4u, MAX_LEVELS>,
}

@group(0) @binding(1) var<uniform> mask_levels: MaskLevels;
@group(0) @binding(2) var<storage, read> masks: array<u32>;

fn mask_entry(first_entry: u32, corner: vec3u, dimensions: vec3u) -> u32 {
    let entries = dimensions + 1u;
    return first_entry + (corner.z * entries.y + corner.y) * entries.x + corner.x;
}

fn lobes_at_level(position_in_grid: vec3f, level: u32) -> u32 {
    let dimensions = grid.dimensions >> vec3u(level);
    let corner = vec3i(floor(position_in_grid * exp2(-f32(level)) + 0.5));
    if any(corner < vec3i(0)) || any(corner > vec3i(dimensions)) {
        return 0u;
    }
    let entry = mask_entry(mask_levels.first_entry[level].x, vec3u(corner), dimensions);
    return (masks[entry >> 1u] >> ((entry & 1u) * 16u)) & 0xffffu;
}

// All lobes that a look-up between two levels can meet.
fn lobes_near(position_in_grid: vec3f, level: f32) -> u32 {
    let fine = u32(level);
    var lobes = lobes_at_level(position_in_grid, fine);
    if level > f32(fine) {
        lobes |= lobes_at_level(position_in_grid, fine + 1u);
    }
    return lobes;
}
