// The boxes of a clipmap (mod.rs), and the storage of their cells. A grid without cascades is one
// box, stored unchanged: CASCADES is then 0, and the functions here compile to almost nothing.
//
// A *level* is a cell size: cells of level l have an edge of 2^l of the finest voxels in every
// cascade. Cascade k has the levels k to k + grid.levels - 1; the first of them are its voxels.

import package::constants::{CASCADES, CASCADE_COLUMNS, CASCADE_EDGE, CASCADE_ROWS};
import package::grid::{grid, grid_from_world};

// A voxel of a box: its coordinates in voxels of the box, from the grid's origin.
struct BoxVoxel {
    voxel: vec3i,
    cascade: u32,
}

fn box_count() -> u32 {
    return max(CASCADES, 1u);
}

// Voxels along each axis of a box.
fn box_size() -> vec3u {
    return select(grid.dimensions, vec3u(CASCADE_EDGE), CASCADES > 0u);
}

// The voxel at a box's corner.
fn lowest_voxel(cascade: u32) -> vec3i {
    if CASCADES == 0u {
        return vec3i(0);
    }
    return grid.lowest[cascade].xyz;
}

// Number of levels over all boxes.
fn level_count() -> u32 {
    return grid.levels + box_count() - 1u;
}

// Range of a box's voxels that triangle walks cover: first inclusive, `walked_high` exclusive.
fn walked_low(cascade: u32) -> vec3i {
    if CASCADES == 0u {
        return vec3i(0);
    }
    return grid.walked_low[cascade].xyz;
}

fn walked_high(cascade: u32) -> vec3i {
    if CASCADES == 0u {
        return vec3i(grid.dimensions);
    }
    return grid.walked_high[cascade].xyz;
}

// Whether a stored voxel is in the range that triangle walks cover.
fn is_walked(stored: vec3u) -> bool {
    let own = voxel_of(stored);
    return all(own.voxel >= walked_low(own.cascade)) && all(own.voxel < walked_high(own.cascade));
}

// The corners of the outermost box in the grid's coordinates.
fn outer_low() -> vec3f {
    return vec3f(lowest_voxel(box_count() - 1u)) * exp2(f32(box_count() - 1u));
}

fn outer_high() -> vec3f {
    return outer_low() + vec3f(box_size()) * exp2(f32(box_count() - 1u));
}

// The modulo, never negative.
fn wrapped(cell: vec3i, edge: i32) -> vec3i {
    return (cell % edge + edge) % edge;
}

// The first cell of a cascade in storage, in units of the cascade's edge.
fn block_of(cascade: u32) -> vec3u {
    let row = cascade / CASCADE_COLUMNS;
    return vec3u(cascade % CASCADE_COLUMNS, row % CASCADE_ROWS, row / CASCADE_ROWS);
}

// The cascade of a stored voxel.
fn cascade_of(stored: vec3u) -> u32 {
    if CASCADES == 0u {
        return 0u;
    }
    let block = stored / CASCADE_EDGE;
    return block.x + CASCADE_COLUMNS * (block.y + CASCADE_ROWS * block.z);
}

// The place of a cascade's cell in storage. `up` is the cell's level minus the cascade's number.
fn stored_cell(cell: vec3i, up: u32, cascade: u32) -> vec3u {
    if CASCADES == 0u {
        return vec3u(cell);
    }
    let edge = CASCADE_EDGE >> up;
    return vec3u(wrapped(cell, i32(edge))) + block_of(cascade) * edge;
}

// The voxel at a stored position.
fn voxel_of(stored: vec3u) -> BoxVoxel {
    let cascade = cascade_of(stored);
    if CASCADES == 0u {
        return BoxVoxel(vec3i(stored), cascade);
    }
    let edge = i32(CASCADE_EDGE);
    let lowest = lowest_voxel(cascade);
    let turned = vec3i(stored) - vec3i(block_of(cascade)) * edge;
    return BoxVoxel(lowest + wrapped(turned - lowest, edge), cascade);
}

// The stored position of the cell after a stored cell, along some axes. After a box's last cell
// comes its first.
fn stored_after(stored: vec3u, offset: vec3u, up: u32) -> vec3u {
    if CASCADES == 0u {
        return stored + offset;
    }
    let edge = CASCADE_EDGE >> up;
    let block = stored / edge;
    return block * edge + (stored - block * edge + offset) % edge;
}

// A position within a stored voxel, in the grid's coordinates.
fn grid_from_stored(stored: vec3u, position_in_voxel: vec3f) -> vec3f {
    let own = voxel_of(stored);
    return (vec3f(own.voxel) + position_in_voxel) * exp2(f32(own.cascade));
}

// Whether a position is inside a cascade by at least a margin in the finest voxels.
fn is_held(cascade: u32, position_in_grid: vec3f, margin: f32) -> bool {
    let own = grid.boxes[cascade];
    let from_middle = abs(position_in_grid - own.xyz);
    return max(from_middle.x, max(from_middle.y, from_middle.z)) <= own.w - margin;
}

// The finest level, `least` or coarser, with cells at a position, at least `margin` of the
// cascade's voxels from the border. Outside of all cascades, the level of the outermost one.
fn finest_level(position_in_grid: vec3f, least: u32, margin: f32) -> u32 {
    var level = least;
    while level + 1u < CASCADES && !is_held(level, position_in_grid, margin * exp2(f32(level))) {
        level++;
    }
    return level;
}

// The cascade that a filtered look-up of a level reads: the finest one that contains all cells of
// the filter.
fn cascade_at(position_in_grid: vec3f, level: u32) -> u32 {
    if CASCADES == 0u {
        return 0u;
    }
    let last = min(level, CASCADES - 1u);
    var cascade = max(level + 1u, grid.levels) - grid.levels;
    while cascade < last && !is_held(cascade, position_in_grid, 0.5 * exp2(f32(level))) {
        cascade++;
    }
    return cascade;
}

// The edge of the finest voxels at a position, m.
fn voxel_size_at(position_in_world: vec3f) -> f32 {
    let level = finest_level(grid_from_world(position_in_world), 0u, 0.5);
    return grid.voxel_size_m * exp2(f32(level));
}

// The zone in which surfaces change to the next cascade: distances from the finer cascade's border,
// in its voxels. Cones and frames draw a distance between the two, so that the border is not
// visible.
const NARROW_BORDER: f32 = 3.0;
const WIDE_BORDER: f32 = 9.0;

// The level of a surface's voxels; `drawn` in [0, 1) selects the distance from the border.
fn drawn_level(position_in_world: vec3f, drawn: f32) -> u32 {
    let place = grid_from_world(position_in_world);
    return finest_level(place, 0u, mix(NARROW_BORDER, WIDE_BORDER, drawn));
}

// The cascade whose cells of a level are shown: the one whose voxels they are, or the outermost.
fn shown_cascade(level: u32) -> u32 {
    return min(level, box_count() - 1u);
}

// The cell of a level at the corner of its box.
fn lowest_cell(level: u32) -> vec3i {
    let cascade = shown_cascade(level);
    return lowest_voxel(cascade) >> vec3u(level - cascade);
}

// The place in storage of a cell, which is given relative to its box's corner, `up` levels above
// the voxels of the cascade.
fn stored_from_corner(cell: vec3u, up: u32, cascade: u32) -> vec3u {
    return stored_cell((lowest_voxel(cascade) >> vec3u(up)) + vec3i(cell), up, cascade);
}
