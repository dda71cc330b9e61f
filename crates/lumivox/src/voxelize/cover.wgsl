// The place of a triangle's piece within its voxel, as bits, so that pieces can be combined in any
// order.
//
// Seen along the lobe's axis, the voxel's side has 8 x 8 squares with a bit each, set if the piece
// touches the square. Four profiles of 32 bits, along u, v, u + v and u - v, are finer but convex.
// A point is covered if its bits are set in the mask and in all profiles.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::voxelize::walk::Walk;

struct Cover {
    mask: vec2u,
    profiles: vec4u,
}

// Bound of the rounding error, in voxels.
const ROUNDING = 1.0 / 1024.0;

// Half the side of a square of the mask.
const HALF_SQUARE = 0.0625;

// Projects a point of the voxel's side onto the axes of the profiles, each from 0 to 1.
fn on_profiles(uv: vec2f) -> vec4f {
    return vec4f(uv, 0.5 * (uv.x + uv.y), 0.5 * (uv.x - uv.y) + 0.5);
}

// The minimum and maximum of a piece along each profile's axis.
struct Extent {
    low: vec4f,
    high: vec4f,
}

fn reach(extent: ptr<function, Extent>, uv: vec2f, is_there: bool) {
    let at = on_profiles(clamp(uv, vec2f(0.0), vec2f(1.0)));
    (*extent).low = select((*extent).low, min((*extent).low, at), is_there);
    (*extent).high = select((*extent).high, max((*extent).high, at), is_there);
}

// Extends by the part of an edge that is in the voxel.
fn reach_edge(extent: ptr<function, Extent>, a: vec3f, b: vec3f) {
    let along = b - a;
    let inverse = 1.0 / select(along, vec3f(1e-20), abs(along) < vec3f(1e-20));
    let t0 = (vec3f(-ROUNDING) - a) * inverse;
    let t1 = (vec3f(1.0 + ROUNDING) - a) * inverse;
    let enter = min(t0, t1);
    let leave = max(t0, t1);
    let first = max(max(enter.x, enter.y), max(enter.z, 0.0));
    let last = min(min(leave.x, leave.y), min(leave.z, 1.0));
    reach(extent, a.xy + along.xy * first, first <= last);
    reach(extent, a.xy + along.xy * last, first <= last);
}

// The triangle in coordinates relative to the voxel.
struct Own {
    a: vec3f,
    b: vec3f,
    c: vec3f,
    side: f32,
    slope: vec2f,
}

// Signed distance of a point to an edge, positive inside, times the edge's length.
fn inside_of(p: vec2f, start: vec2f, end: vec2f, side: f32) -> f32 {
    let along = end - start;
    let to = p - start;
    return (along.x * to.y - along.y * to.x) * side;
}

fn reach_of(start: vec2f, end: vec2f) -> f32 {
    return abs(end.x - start.x) + abs(end.y - start.y);
}

// Whether a square around a point, with `half` as half its side, may touch the triangle.
fn touches_square(own: Own, p: vec2f, half: f32) -> bool {
    let height = own.a.z + dot(own.slope, p - own.a.xy);
    let rise = half * (abs(own.slope.x) + abs(own.slope.y)) + ROUNDING;
    return inside_of(p, own.a.xy, own.b.xy, own.side) >= -half * reach_of(own.a.xy, own.b.xy)
        && inside_of(p, own.b.xy, own.c.xy, own.side) >= -half * reach_of(own.b.xy, own.c.xy)
        && inside_of(p, own.c.xy, own.a.xy, own.side) >= -half * reach_of(own.c.xy, own.a.xy)
        && height + rise >= 0.0 && height - rise <= 1.0;
}

// Extends by the points where edges of the voxel intersect the triangle.
fn reach_inside(extent: ptr<function, Extent>, own: Own) {
    for (var i = 0u; i < 4u; i++) {
        let low = vec2f(f32(i & 1u), f32(i >> 1u));
        reach(extent, low, touches_square(own, low, ROUNDING));
        // The edges along u and along v.
        let rest = low.y - own.a.z;
        let u = own.a.x + (rest - own.slope.y * (low.x - own.a.y))
            / select(own.slope.x, 1e-20, abs(own.slope.x) < 1e-20);
        let v = own.a.y + (rest - own.slope.x * (low.x - own.a.x))
            / select(own.slope.y, 1e-20, abs(own.slope.y) < 1e-20);
        reach(extent, vec2f(u, low.x), u >= 0.0 && u <= 1.0 && touches_square(own, vec2f(u, low.x), ROUNDING));
        reach(extent, vec2f(low.x, v), v >= 0.0 && v <= 1.0 && touches_square(own, vec2f(low.x, v), ROUNDING));
    }
}

// A mask of the bits from `first` to `last`, both included.
fn bits_between(first: u32, last: u32) -> u32 {
    return (0xffffffffu >> (31u - last)) & (0xffffffffu << first);
}

// Cover of the piece in the walk's current voxel, with the given centroid.
fn cover_of(walk: ptr<function, Walk>, centroid: vec3f) -> Cover {
    let corner = vec3f((*walk).voxel);
    let own = Own(
        (*walk).a - corner, (*walk).b - corner, (*walk).c - corner, sign((*walk).normal.z), (*walk).slope);
    let middle = on_profiles(clamp(centroid.xy - corner.xy, vec2f(0.0), vec2f(1.0)));
    var extent = Extent(middle, middle);
    reach_edge(&extent, own.a, own.b);
    reach_edge(&extent, own.b, own.c);
    reach_edge(&extent, own.c, own.a);
    reach_inside(&extent, own);

    let first = vec4u(clamp(floor(32.0 * (extent.low - ROUNDING)), vec4f(0.0), vec4f(31.0)));
    let last = vec4u(clamp(floor(32.0 * (extent.high + ROUNDING)), vec4f(0.0), vec4f(31.0)));
    var cover = Cover(vec2u(0u), vec4u(
        bits_between(first.x, last.x),
        bits_between(first.y, last.y),
        bits_between(first.z, last.z),
        bits_between(first.w, last.w),
    ));
    for (var v = first.y / 4u; v <= last.y / 4u; v++) {
        var row = 0u;
        for (var u = first.x / 4u; u <= last.x / 4u; u++) {
            let p = (vec2f(vec2u(u, v)) + 0.5) / 8.0;
            row |= select(0u, 1u << u, touches_square(own, p, HALF_SQUARE));
        }
        cover.mask[v / 4u] |= row << (8u * (v % 4u));
    }
    // Always set the square of the centroid.
    let square = vec2u(min(8.0 * middle.xy, vec2f(7.0)));
    cover.mask[square.y / 4u] |= 1u << (8u * (square.y % 4u) + square.x);
    return cover;
}
