// The piece of a triangle inside a voxel: its area and its centroid, without building the clipped
// polygon.
//
// Seen along the dominant axis w, the piece is the triangle's projection, cut to the voxel's square
// and to the slab between the voxel's lower and upper depth. Green's theorem turns area and first
// moments into integrals along the boundary. The boundary of triangle and slab is the three edges,
// each cut to the slab, and two lines that close it where it leaves and re-enters the slab. Cutting
// to the square needs no new vertices: for each v the extent along u of a region within [low, high]
// is the sum, with the sign of the crossing, of the boundary's u clamped to [low, high] (the exact
// area coverage of Catmull 1978, "A hidden-surface algorithm with anti-aliasing", in the form that
// font rasterizers use). No arrays, hardly a branch.
//
// The slab is half open (it includes its lower end, but not its upper end): surface in the plane
// between two voxels is counted once.

import package::voxelize::walk::Walk;

struct Piece {
    // Area seen along w, in voxel sides; 0 if there is no piece.
    area: f32,
    // The centroid, in the walk's coordinates.
    centroid: vec3f,
}

// The part of an edge inside a slab, seen along w, and whether it crosses the slab's ends.
struct Cut {
    start: vec2f,
    end: vec2f,
}

// The contribution of an edge to the boundary integrals: of u dv, u^2 / 2 dv and u v dv.
fn integrals(start: vec2f, end: vec2f, low: vec2f, high: vec2f) -> vec3f {
    // Cuts the edge to the square along v.
    let run = end - start;
    let du_dv = run.x * select(1.0 / run.y, 0.0, run.y == 0.0);
    let v0 = clamp(start.y, low.y, high.y);
    let v3 = clamp(end.y, low.y, high.y);
    let u_start = start.x + (v0 - start.y) * du_dv;
    let u_end = end.x - (end.y - v3) * du_dv;
    // Clamped along u, it becomes a vertical, a slanted and a vertical part (each may be empty).
    let u0 = clamp(u_start, low.x, high.x);
    let u1 = clamp(u_end, low.x, high.x);
    let du = u_end - u_start;
    let inverse = select(1.0 / du, 0.0, du == 0.0);
    let height = v3 - v0;
    let v1 = v0 + height * clamp((u0 - u_start) * inverse, 0.0, 1.0);
    let v2 = v3 - height * clamp((u_end - u1) * inverse, 0.0, 1.0);
    let d = vec3f(v1 - v0, v2 - v1, v3 - v2);
    return vec3f(
        dot(d, vec3f(u0, 0.5 * (u0 + u1), u1)),
        dot(d, vec3f(0.5 * u0 * u0, (u0 * u0 + u0 * u1 + u1 * u1) / 6.0, 0.5 * u1 * u1)),
        dot(d, vec3f(
            0.5 * u0 * (v0 + v1),
            (u0 * (2.0 * v1 + v2) + u1 * (v1 + 2.0 * v2)) / 6.0,
            0.5 * u1 * (v2 + v3),
        )),
    );
}

// The part of the edge from a to b with depth in [low, high). The ends are exactly a and b if those
// are inside, so that the boundary stays closed.
fn cut_edge(a: vec3f, b: vec3f, low: f32, high: f32) -> Cut {
    let rise = b.z - a.z;
    let inverse = select(1.0 / rise, 0.0, rise == 0.0);
    let before = clamp((clamp(a.z, low, high) - a.z) * inverse, 0.0, 1.0);
    let after = clamp((b.z - clamp(b.z, low, high)) * inverse, 0.0, 1.0);
    let run = b.xy - a.xy;
    let start = a.xy + run * before;
    let is_apart = max(a.z, b.z) < low || min(a.z, b.z) >= high;
    return Cut(start, select(b.xy - run * after, start, is_apart));
}

fn piece_in_voxel(walk: ptr<function, Walk>) -> Piece {
    let corner = vec3f((*walk).voxel);
    let normal = (*walk).normal;
    // The triangle's box within the voxel.
    let least = min((*walk).a, min((*walk).b, (*walk).c));
    let most = max((*walk).a, max((*walk).b, (*walk).c));
    let box_low = clamp(least, corner, corner + 1.0);
    let box_high = clamp(most, corner, corner + 1.0);
    let is_whole = all(least >= corner) && all(most <= corner + 1.0) && least.z < corner.z + 1.0;

    // Coordinates are relative to a point near the piece, so that the integrals of a tiny piece are
    // sums of tiny numbers. Depth is not shifted, so that neighbouring voxels compare it with the
    // same number.
    let origin = vec3f(box_low.xy, 0.0);
    let low = corner - origin;
    let high = low + 1.0;
    let a = (*walk).a - origin;
    let b = (*walk).b - origin;
    let c = (*walk).c - origin;
    let ab = cut_edge(a, b, low.z, high.z);
    let bc = cut_edge(b, c, low.z, high.z);
    let ca = cut_edge(c, a, low.z, high.z);
    var sum = integrals(ab.start, ab.end, low.xy, high.xy)
        + integrals(bc.start, bc.end, low.xy, high.xy)
        + integrals(ca.start, ca.end, low.xy, high.xy);

    // The lines that close the boundary between leaving and re-entering the slab.
    let below = vec3<bool>(a.z < low.z, b.z < low.z, c.z < low.z);
    let next_below = below.yzx;
    if any(below) {
        let leaves = !below & next_below;
        let enters = below & !next_below;
        let exit = select(select(ca.end, bc.end, leaves.y), ab.end, leaves.x);
        let entry = select(select(ca.start, bc.start, enters.y), ab.start, enters.x);
        if any(leaves) {
            sum += integrals(exit, entry, low.xy, high.xy);
        }
    }
    let above = vec3<bool>(a.z >= high.z, b.z >= high.z, c.z >= high.z);
    let next_above = above.yzx;
    if any(above) {
        let leaves = !above & next_above;
        let enters = above & !next_above;
        let exit = select(select(ca.end, bc.end, leaves.y), ab.end, leaves.x);
        let entry = select(select(ca.start, bc.start, enters.y), ab.start, enters.x);
        if any(leaves) {
            sum += integrals(exit, entry, low.xy, high.xy);
        }
    }
    sum *= sign(normal.z);

    var piece = Piece(0.0, vec3f(0.0));
    // The sums' terms are at most as large as the box, each off by a few roundings.
    let box = box_high.xy - box_low.xy;
    if is_whole {
        piece.area = 0.5 * abs(normal.z);
        piece.centroid = ((*walk).a + (*walk).b + (*walk).c) / 3.0;
    } else if sum.x > box.x * box.y / 2097152.0 {
        piece.area = min(min(sum.x, 0.5 * abs(normal.z)), 1.0);
        let uv = origin.xy + sum.yz / sum.x;
        let depth = (*walk).a.z + dot((*walk).slope, uv - (*walk).a.xy);
        piece.centroid = clamp(vec3f(uv, depth), box_low, box_high);
    }
    return piece;
}
