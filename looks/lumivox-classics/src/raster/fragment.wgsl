// Turns a fragment into a walk (walk.wgsl) over the one or few voxels of its column that it
// represents, so that they are processed as in the exact walk.

import package::constants::{RASTER_CONSERVATIVE, RASTER_METHOD, RASTER_THREE_PLANE, TILE_EDGE};
import package::voxelize::footprint::{footprint, tile_counts, turn, turn_back};
import package::voxelize::items::{Item, run};
import package::voxelize::overlap::{SideTests, touches};
import package::voxelize::piece::Piece;
import package::classics::raster::share::share_of_pixel;
import package::voxelize::reproducible::dot_fused;
import package::voxelize::triangles::{Triangle, load_triangle};
import package::voxelize::walk::{Walk, walk_begin, walk_on};

const IS_CONSERVATIVE = RASTER_METHOD == RASTER_CONSERVATIVE;

// The point at which a triangle's plane passes the centre of a pixel of the picture along `axis`,
// in grid space. Fused, so that all walks find the same voxel.
fn point_at(pixel: vec2f, triangle: Triangle, normal: vec3f, axis: u32) -> vec3f {
    let a = turn(triangle.a, axis);
    let b = turn(triangle.b, axis);
    let c = turn(triangle.c, axis);
    let n = turn(normal, axis);
    let slope = -n.xy / n.z;
    let offset = pixel - a.xy;
    let depth = fma(slope.x, offset.x, fma(slope.y, offset.y, a.z));
    // Rasterizers round corners, so that a centre may lie a little outside.
    let low = min(a.z, min(b.z, c.z));
    let high = max(a.z, max(b.z, c.z));
    return turn_back(vec3f(pixel, clamp(depth, low, high)), axis);
}

// Largest error of a plane's depth that only rounding causes, in voxels.
const LARGEST_UNCERTAINTY = 1.0 / 1024.0;

// Axes closer to parallel to the plane than this slope do not count: corners are rounded to a
// raster of 1/256, and rounding would decide in which voxel such an axis meets the plane.
const GRAZING = 1.0 / 256.0;

// The area that a fragment represents, seen along the dominant axis.
//
// Along the dominant axis a pixel's centre represents the pixel: an area of 1. With three planes,
// the lines through a voxel's middle along the axes meet a triangle's plane in the voxel once,
// twice or three times. Each of these points that the triangle covers is a fragment, and together
// the points share an area of 1. So a plane has its area, with at most 1 in a voxel, and a triangle
// smaller than a voxel has its area in the mean.
fn area_of(normal: vec3f, axis: u32, point: vec3f) -> f32 {
    if RASTER_METHOD != RASTER_THREE_PLANE {
        return 1.0;
    }
    let size = abs(normal);
    let least = GRAZING * max(size.x, max(size.y, size.z));
    // Distance from the plane to the voxel's middle, times the normal's length.
    let apart = abs(dot_fused(normal, floor(point) + 0.5 - point));
    var count = 1.0;
    for (var other = 0u; other < 3u; other++) {
        count += select(0.0, 1.0, other != axis && size[other] > least && 2.0 * apart < size[other]);
    }
    return 1.0 / count;
}

struct Fragment {
    // Whether the fragment has a voxel; the walk is then at its first one.
    is_there: bool,
    // The surface that the fragment represents, if it does not depend on the voxel.
    piece: Piece,
}

fn fragment_begin(walk: ptr<function, Walk>, position: vec2f, index: u32, axis: u32) -> Fragment {
    let triangle = load_triangle(index, run.first_draw, run.end_draw);
    let area = footprint(triangle);
    let normal = turn_back(area.normal, area.axis);
    let pixel = floor(position) + 0.5;
    // In the walk's axes, along the dominant axis.
    var point = vec3f(pixel, 0.0);
    var stands_for = 0.0;
    if !IS_CONSERVATIVE {
        let point_in_grid = point_at(pixel, triangle, normal, axis);
        stands_for = area_of(normal, axis, point_in_grid);
        point = turn(point_in_grid, area.axis);
    }
    let cell = vec3i(floor(point));
    let is_inside = all(cell.xy >= area.first.xy) && all(cell.xy <= area.last.xy);

    let tile = vec2u(clamp(cell.xy, area.first.xy, area.last.xy) - area.first.xy) / TILE_EDGE;
    *walk = walk_begin(Item(true, index, tile.y * tile_counts(area).x + tile.x));
    (*walk).voxel = cell - (*walk).base;
    if IS_CONSERVATIVE {
        // Just before the only column.
        (*walk).last_column = (*walk).voxel.xy;
        (*walk).voxel = vec3i((*walk).voxel.x - 1, (*walk).voxel.y, 0);
        return Fragment(is_inside && walk_on(walk), Piece(0.0, vec3f(0.0)));
    }
    let is_there = is_inside && cell.z >= area.first.z && cell.z <= area.last.z;
    return Fragment(is_there, Piece(stands_for, point - vec3f((*walk).base)));
}

// Whether the current voxel counts as touched. Rounding makes a sliver's plane uncertain, and its
// range of depth may be its whole box: then the edges seen along the two other axes decide, as in
// the exact walk.
fn is_touched(walk: ptr<function, Walk>, tests: SideTests) -> bool {
    let uncertainty = (*walk).widening - 0.5 * (abs((*walk).slope.x) + abs((*walk).slope.y));
    return !IS_CONSERVATIVE || uncertainty < LARGEST_UNCERTAINTY || touches(walk, tests);
}

// Moves to the next voxel; false if there is none left.
fn fragment_on(walk: ptr<function, Walk>) -> bool {
    if IS_CONSERVATIVE {
        return walk_on(walk);
    }
    return false;
}

// The surface in the current voxel.
fn piece_of(walk: ptr<function, Walk>, fragment: Fragment) -> Piece {
    if IS_CONSERVATIVE {
        return share_of_pixel(walk);
    }
    return fragment.piece;
}
