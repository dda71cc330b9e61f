// The columns of voxels that a triangle covers, seen along the dominant axis of its normal, and how
// they are cut into tiles. A tile is a work item: no thread walks a whole wall.
//
// "Walk order" names the axes (u, v, w): w is the dominant axis, and the permutation is cyclic, so
// that it preserves the side that a triangle faces. Since w is dominant, the plane's slope along u
// and v is at most 1.

import package::cascades::{walked_high, walked_low};
import package::constants::{CASCADES, TILE_EDGE};
import package::voxelize::reproducible::{cross_fused, is_finite};
import package::voxelize::triangles::Triangle;

// A second axis must beat the first by this factor to be the dominant one. Rounding then cannot
// scatter the triangles of a plane at 45 degrees over two axes; the chosen axis may be off by the
// same factor.
const DOMINANCE = 1.0 + 1.0 / 8192.0;

// Below this, a cross product (twice an area, in voxels) is rounding or near underflow.
const SMALLEST_CROSS = 1e-30;

struct Footprint {
    // The dominant axis: 0, 1, 2 for x, y, z.
    axis: u32,
    // The normal in walk order; its length is twice the triangle's area.
    normal: vec3f,
    // The voxels of the triangle's box inside the walked part of the cascade, in walk order, both
    // ends included.
    first: vec3i,
    last: vec3i,
    // Whether the triangle has no area, or is not finite.
    is_degenerate: bool,
    // Whether no voxel of the cascade touches its box.
    is_outside: bool,
}

// Converts to walk order.
fn turn(v: vec3f, axis: u32) -> vec3f {
    return select(select(v.yzx, v.zxy, axis == 1u), v, axis == 2u);
}

// Converts from walk order.
fn turn_back(v: vec3f, axis: u32) -> vec3f {
    return select(select(v.zxy, v.yzx, axis == 1u), v, axis == 2u);
}

fn turn_back_cell(v: vec3i, axis: u32) -> vec3i {
    return select(select(v.zxy, v.yzx, axis == 1u), v, axis == 2u);
}

fn dominant_axis(normal: vec3f) -> u32 {
    let size = abs(normal);
    let xy = select(0u, 1u, size.y > size.x * DOMINANCE);
    let larger = select(size.x, size.y, xy == 1u);
    return select(xy, 2u, size.z > larger * DOMINANCE);
}

// A triangle in units of a cascade's voxels.
fn in_cascade(triangle: Triangle, cascade: u32) -> Triangle {
    let scale = exp2(-f32(cascade));
    return Triangle(
        scale * triangle.a, scale * triangle.b, scale * triangle.c, triangle.vertices, triangle.draw);
}

// Footprint in a grid without cascades.
fn footprint(triangle: Triangle) -> Footprint {
    return footprint_in(triangle, 0u);
}

// Footprint of a triangle in units of a cascade's voxels.
fn footprint_in(triangle: Triangle, cascade: u32) -> Footprint {
    let cross = cross_fused(triangle.b - triangle.a, triangle.c - triangle.a);
    var result: Footprint;
    result.axis = dominant_axis(cross);
    result.normal = turn(cross, result.axis);
    result.is_degenerate = !(is_finite(triangle.a) && is_finite(triangle.b) && is_finite(triangle.c)
        && is_finite(cross) && abs(result.normal.z) > SMALLEST_CROSS);

    // Voxels are closed boxes here: a point on a boundary belongs to the voxels on both sides of
    // it.
    let low = min(triangle.a, min(triangle.b, triangle.c));
    let high = max(triangle.a, max(triangle.b, triangle.c));
    let lowest = vec3f(walked_low(cascade));
    let end = vec3f(walked_high(cascade));
    let first = clamp(ceil(low) - 1.0, lowest, end);
    let last = clamp(floor(high), lowest - 1.0, end - 1.0);
    result.first = vec3i(turn(first, result.axis));
    result.last = vec3i(turn(last, result.axis));
    result.is_outside = any(first > last);
    return result;
}

// The column from which tiles are counted. With cascades it does not depend on the position of the
// box, so that sums are identical to the bit.
fn first_tile(area: Footprint) -> vec2i {
    if CASCADES == 0u {
        return area.first.xy;
    }
    return area.first.xy & vec2i(-i32(TILE_EDGE));
}

// Tiles along u and v.
fn tile_counts(area: Footprint) -> vec2u {
    if area.is_outside {
        return vec2u(0u);
    }
    let columns = vec2u(area.last.xy - first_tile(area) + 1);
    return (columns + TILE_EDGE - 1u) / TILE_EDGE;
}
