// Walks the voxels that one tile of a triangle may touch: in each column, those in the depth range
// of the triangle's plane.
//
// All coordinates are in walk order (footprint.wgsl) and relative to a voxel near the tile, so that
// rounding errors are those of small numbers. Every test is widened by a bound of its own rounding
// error: it may accept a voxel that the triangle misses by a hair, but never rejects one that it
// touches.

import package::cascades::{box_count, stored_cell};
import package::constants::{CASCADES, TILE_EDGE};
import package::voxelize::footprint::{
    Footprint, first_tile, footprint_in, in_cascade, tile_counts, turn, turn_back_cell,
};
import package::voxelize::items::{Item, run};
import package::voxelize::triangles::{Triangle, draws, load_triangle};

// A sum of three products of numbers up to m, each off by its own rounding (2^-24) and by that of
// its factors, is off by less than 8 * 2^-24 m.
const ROUNDING = 1.0 / 2097152.0;

// Farther than any voxel, but small enough that `f32` represents every integer up to it.
const BEYOND_VOXELS = 8388608.0;

// An interval test (Akenine-Möller 2001, "Fast 3D triangle-box overlap testing", section 2) along
// the normal m of a triangle's edge in a projection: a unit square with its centre at p does not
// overlap the triangle if abs(m . p + offset) > reach. It needs no orientation, which rounding may
// flip for a sliver.
struct EdgeTest {
    m: vec2f,
    offset: f32,
    reach: f32,
}

// The test of the edge from `start` to `end`; `other` is the third corner, and no coordinate
// exceeds `extent`.
fn edge_test(start: vec2f, end: vec2f, other: vec2f, extent: f32) -> EdgeTest {
    let m = vec2f(end.y - start.y, start.x - end.x);
    let width = dot(m, other - start);
    let size = abs(m.x) + abs(m.y);
    return EdgeTest(m, -dot(m, start) - 0.5 * width, 0.5 * abs(width) + (0.5 + ROUNDING * extent) * size);
}

fn may_touch(test: EdgeTest, centre: vec2f) -> bool {
    return abs(dot(test.m, centre) + test.offset) <= test.reach;
}

struct Walk {
    // The corners, and the normal, whose length is twice the area.
    a: vec3f,
    b: vec3f,
    c: vec3f,
    normal: vec3f,
    // The voxel that coordinates are relative to, in walk order.
    base: vec3i,
    axis: u32,
    cascade: u32,
    vertices: vec3u,
    draw: u32,
    // Bound of the coordinates, for rounding errors.
    extent: f32,
    // The edges, seen along w.
    ab: EdgeTest,
    bc: EdgeTest,
    ca: EdgeTest,
    // Slope of the plane's depth along u and v, and the distance by which a column's range is
    // widened.
    slope: vec2f,
    widening: f32,
    // Depth range of the triangle, and depth limits of the cascade.
    depth_range: vec2f,
    depth_limits: vec2i,
    // The first and the last column of the tile; the current voxel, and the last one of its column.
    first_column: vec2i,
    last_column: vec2i,
    voxel: vec3i,
    last_depth: i32,
}

// An item's cascade, its triangle there, and its tile among those of that cascade.
struct ItemInCascade {
    triangle: Triangle,
    area: Footprint,
    cascade: u32,
    tile: u32,
}

fn item_in_cascade(item: Item) -> ItemInCascade {
    let triangle = load_triangle(item.triangle, run.first_draw, run.end_draw);
    let cascades = draws[triangle.draw].cascades;
    let first = min(countTrailingZeros(cascades), box_count() - 1u);
    let in_first = in_cascade(triangle, first);
    var own = ItemInCascade(in_first, footprint_in(in_first, first), first, item.tile);
    loop {
        let tiles = tile_counts(own.area);
        let has_none = own.area.is_degenerate || ((cascades >> own.cascade) & 1u) == 0u;
        let count = select(tiles.x * tiles.y, 0u, has_none);
        if own.tile < count || own.cascade + 1u >= box_count() {
            break;
        }
        own.tile -= count;
        own.cascade += 1u;
        own.triangle = in_cascade(triangle, own.cascade);
        own.area = footprint_in(own.triangle, own.cascade);
    }
    return own;
}

// Starts before the first voxel of an item; `walk_on` moves to it.
fn walk_begin(item: Item) -> Walk {
    var walk: Walk;
    walk.voxel = vec3i(-1, 0, 0);
    walk.last_depth = -1;
    walk.last_column = vec2i(-1);
    if !item.exists {
        return walk;
    }
    let own = item_in_cascade(item);
    let triangle = own.triangle;
    let area = own.area;
    walk.axis = area.axis;
    walk.cascade = own.cascade;
    walk.normal = area.normal;
    walk.draw = triangle.draw;
    walk.vertices = triangle.vertices;

    let tiles = tile_counts(area);
    let corner = first_tile(area) + vec2i(vec2u(own.tile % tiles.x, own.tile / tiles.x) * TILE_EDGE);
    walk.first_column = max(area.first.xy - corner, vec2i(0));
    walk.last_column = min(area.last.xy - corner, vec2i(i32(TILE_EDGE) - 1));
    walk.voxel = vec3i(walk.first_column - vec2i(1, 0), 0);

    // Depth is relative to the point where the plane passes the tile's middle.
    let a = turn(triangle.a, walk.axis);
    let b = turn(triangle.b, walk.axis);
    let c = turn(triangle.c, walk.axis);
    walk.slope = -walk.normal.xy / walk.normal.z;
    let middle = vec2f(corner) + 0.5 * f32(TILE_EDGE);
    let depth = a.z + dot(walk.slope, middle - a.xy);
    // With cascades, the range does not depend on the position of the box.
    let held = vec2f(vec2i(area.first.z, area.last.z));
    let range = select(held, BEYOND_VOXELS * vec2f(-1.0, 1.0), CASCADES > 0u);
    walk.base = vec3i(corner, i32(clamp(depth, range.x, range.y)));
    walk.a = a - vec3f(walk.base);
    walk.b = b - vec3f(walk.base);
    walk.c = c - vec3f(walk.base);
    let low = min(walk.a, min(walk.b, walk.c));
    let high = max(walk.a, max(walk.b, walk.c));
    let farthest = max(-low, high);
    walk.extent = max(farthest.x, max(farthest.y, farthest.z)) + f32(TILE_EDGE);

    walk.ab = edge_test(walk.a.xy, walk.b.xy, walk.c.xy, walk.extent);
    walk.bc = edge_test(walk.b.xy, walk.c.xy, walk.a.xy, walk.extent);
    walk.ca = edge_test(walk.c.xy, walk.a.xy, walk.b.xy, walk.extent);

    // A component of the normal is off by up to 4 * 2^-24 of the product of two edges, and the
    // slope, a quotient of at most 1, by twice that over normal.z. That is rounding for a compact
    // triangle, but large for a sliver, for which only the edge tests decide.
    let size = high - low;
    let edges = max(size.x, max(size.y, size.z));
    walk.widening = ROUNDING * walk.extent * (1.0 + edges * edges / abs(walk.normal.z))
        + 0.5 * (abs(walk.slope.x) + abs(walk.slope.y));
    walk.depth_range = vec2f(low.z, high.z);
    walk.depth_limits = vec2i(area.first.z, area.last.z) - walk.base.z;
    return walk;
}

// Moves to the next voxel that the triangle may touch; returns false if there is none left.
//
// Loops here and around calls of this function test at their end: a software GPU runs eight threads
// in lockstep, and after a failed test at the start it would run the body once more.
fn walk_on(walk: ptr<function, Walk>) -> bool {
    (*walk).voxel.z += 1;
    if (*walk).voxel.z <= (*walk).last_depth {
        return true;
    }
    // The next column with a non-empty depth range.
    loop {
        (*walk).voxel.x += 1;
        if (*walk).voxel.x > (*walk).last_column.x {
            (*walk).voxel.x = (*walk).first_column.x;
            (*walk).voxel.y += 1;
        }
        if (*walk).voxel.y > (*walk).last_column.y {
            return false;
        }
        let centre = vec2f((*walk).voxel.xy) + 0.5;
        if may_touch((*walk).ab, centre) && may_touch((*walk).bc, centre) && may_touch((*walk).ca, centre) {
            let depth = (*walk).a.z + dot((*walk).slope, centre - (*walk).a.xy);
            let low = max(depth - (*walk).widening, (*walk).depth_range.x);
            let high = min(depth + (*walk).widening, (*walk).depth_range.y);
            let limits = vec2f((*walk).depth_limits);
            (*walk).voxel.z = i32(clamp(ceil(low) - 1.0, limits.x, limits.y + 1.0));
            (*walk).last_depth = i32(clamp(floor(high), limits.x - 1.0, limits.y));
        }
        continuing {
            break if (*walk).voxel.z <= (*walk).last_depth;
        }
    }
    return true;
}

// The cell in which the current voxel is stored.
fn walk_cell(walk: ptr<function, Walk>) -> vec3u {
    let voxel = turn_back_cell((*walk).base + (*walk).voxel, (*walk).axis);
    return stored_cell(voxel, 0u, (*walk).cascade);
}
