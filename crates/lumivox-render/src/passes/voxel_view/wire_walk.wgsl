// Wire cubes along a pixel's ray: the outlines of faces between an occupied cell and an empty one.
//
// The walk uses the occupancy bits of the voxel list, block by block: an empty block of a coarser
// level is crossed in one step, and the next block tried is twice as large; a block that is not
// empty is searched.

import package::cascades::{box_size, lowest_cell, shown_cascade, stored_from_corner};
import package::grid::{grid, grid_from_world};
import package::render::passes::voxel_view::cell_walk::{longest_walk, walk_into};
import package::trace::view::{ray_direction, view};
import package::voxels::lookup::{level_first_word, level_words};
import package::voxels::morton::morton_encode;

@group(1) @binding(2) var<storage, read> occupancy: array<u32>;

// Half the width of a line in pixels.
const HALF_WIDTH: f32 = 0.55;
// If a pixel is wider than this share of a cell, lines fade in proportion to their density.
const DENSEST: f32 = 0.15;
// A ray with at least this coverage hides everything behind it.
const COVERED: f32 = 0.99;

struct Wires {
    coverage: f32,
    // The cell of the first line.
    cell: vec3u,
}

// A pixel's ray in units of cells of a level, and its change from pixel to pixel.
struct PixelRay {
    origin: vec3f,
    direction: vec3f,
    across: vec3f,
    down: vec3f,
}

// The cascade, the level minus the cascade, its first bit, and its cells along each axis.
struct LevelBits {
    cascade: u32,
    up: u32,
    first_word: u32,
    size: vec3i,
}

// `cell` is relative to its box's corner.
fn has_voxel(cell: vec3u, up: u32, cascade: u32, first_word: u32) -> bool {
    let code = morton_encode(stored_from_corner(cell, up, cascade));
    return ((occupancy[first_word + code / 32u] >> (code & 31u)) & 1u) != 0u;
}

// The share of a pixel that the outline of a crossed face covers; `cell` is the occupied one.
// Distances from the edges are measured on the screen, so that lines have the same width at any
// distance and slant. For small cells, lines turn into an even tint, which fades where a pixel is
// as wide as several cells.
fn outline_of(
    ray: PixelRay,
    cell: vec3i,
    axis: u32,
    distance: f32,
    is_entry: bool,
    level: LevelBits,
) -> f32 {
    let position = ray.origin + distance * ray.direction;
    var coverage = 0.0;
    for (var turn = 1u; turn <= 2u; turn++) {
        let beside = (axis + turn) % 3u;
        let edge = round(position[beside]);
        let lean = ray.direction[beside] / ray.direction[axis];
        let step = vec2f(
            ray.across[beside] - lean * ray.across[axis],
            ray.down[beside] - lean * ray.down[axis],
        );
        // The width of a pixel in cells.
        let pixel = max(distance * length(step), 1e-12);
        let pixels_off = abs(position[beside] - edge) / pixel;
        // Half of a line is on this face, the other half on the adjacent one; the outermost visible
        // edges have no adjacent face.
        let is_high = edge > f32(cell[beside]) + 0.5;
        var width = HALF_WIDTH;
        if is_entry && pixels_off < 2.0 * HALF_WIDTH && (ray.direction[beside] > 0.0) == is_high {
            var next = cell;
            next[beside] += select(-1, 1, is_high);
            let is_outside = next[beside] < 0 || next[beside] >= level.size[beside];
            let is_next_there = !is_outside && has_voxel(vec3u(next), level.up, level.cascade, level.first_word);
            width = select(2.0 * HALF_WIDTH, HALF_WIDTH, is_next_there);
        }
        let strength = saturate(DENSEST / pixel);
        coverage = max(coverage, select(0.0, strength, pixels_off < width));
    }
    return coverage;
}

// The wires of a level in a pixel, up to the distance `end` in cells.
fn wires_along(pixel: vec2u, level: u32, end: f32) -> Wires {
    let direction = ray_direction(pixel);
    let ray = PixelRay(
        grid_from_world(view.position_in_world) * exp2(-f32(level)) - vec3f(lowest_cell(level)),
        direction,
        ray_direction(pixel + vec2u(1u, 0u)) - direction,
        ray_direction(pixel + vec2u(0u, 1u)) - direction,
    );
    let cascade = shown_cascade(level);
    let stored_level = level - cascade;
    let size = vec3i(box_size() >> vec3u(stored_level));
    let entry = walk_into(ray.origin, ray.direction, vec3f(size));
    let own = LevelBits(cascade, stored_level, level_first_word(stored_level), size);
    let most_up = grid.levels - 1u - stored_level;
    let forward = vec3i(entry.forward);

    var cell = vec3i(entry.cell);
    var axis = entry.axis;
    var distance = entry.distance;
    // The current block is `up` levels coarser; its level's bits begin at `first_word`.
    var up = 0u;
    var first_word = own.first_word;
    var words = level_words(stored_level);

    var before = cell;
    var was_there = false;
    // No face is crossed in the cell that contains the ray's origin.
    var has_face = distance > 0.0;
    var wires = Wires(0.0, vec3u(0u));
    var is_done = !entry.is_inside;
    var left = 4u * longest_walk(vec3f(size));
    loop {
        let is_inside = all(cell >= vec3i(0)) && all(cell < size);
        let looked_at = vec3u(clamp(cell, vec3i(0), size - 1)) >> vec3u(up);
        let is_there = is_inside && has_voxel(looked_at, stored_level + up, cascade, first_word);
        if is_there && up > 0u {
            up -= 1u;
            words *= 8u;
            first_word -= words;
        } else {
            if is_there != was_there && has_face && !is_done {
                let occupied = select(before, cell, is_there);
                let covered = outline_of(ray, occupied, axis, distance, is_there, own);
                if wires.coverage == 0.0 {
                    wires.cell = vec3u(occupied);
                }
                wires.coverage += (1.0 - wires.coverage) * covered;
            }
            was_there = is_there;
            has_face = true;
            before = cell;
            // Continue through the block, to the next cell behind it.
            let edge = i32(1u << up);
            let low = (cell >> vec3u(up)) << vec3u(up);
            let next = (vec3f(low + select(vec3i(0), vec3i(edge), forward > vec3i(0))) - ray.origin)
                * entry.inverse;
            let crossing = select(next, vec3f(1e30), abs(ray.direction) < vec3f(1e-12));
            axis = 2u;
            if crossing.x <= crossing.y && crossing.x <= crossing.z {
                axis = 0u;
            } else if crossing.y <= crossing.z {
                axis = 1u;
            }
            distance = max(distance, crossing[axis]);
            let at = vec3i(floor(ray.origin + distance * ray.direction));
            cell = clamp(at, low, low + edge - 1);
            cell[axis] = select(low[axis] - 1, low[axis] + edge, forward[axis] > 0);
            is_done = is_done || !is_inside || distance > end || wires.coverage > COVERED;
            if !is_there && up < most_up {
                first_word += words;
                words /= 8u;
                up += 1u;
            }
        }
        left -= 1u;
        continuing {
            break if is_done || left == 0u;
        }
    }
    return wires;
}
