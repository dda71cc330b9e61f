// The surface that a conservative fragment represents in one voxel of its column.
//
// A touched pixel may be covered only in part; counting it as a whole would let a triangle that
// touches a corner weigh as much as one that fills the voxel. The covered area and its centroid
// follow from the boundary integrals of piece.wgsl, without the cut to a slab of depth. Each voxel
// of the column gets the same share of them as of the plane's depth over the pixel, cut to the
// triangle's box. So the areas of a triangle's fragments add up to its own; the shares are exact if
// the pixel is covered as a whole, and an estimate if an edge crosses it.

import package::voxelize::piece::{Piece, integrals};
import package::voxelize::walk::Walk;

// A `narrow` below this counts as 0: the difference of two nearly equal integrals would be inexact.
const SMALLEST_SLOPE = 1.0 / 1024.0;

// The integral of clamp(x / width + 0.5, 0, 1).
fn ramp_integral(x: f32, width: f32) -> f32 {
    let inside = clamp(x + 0.5 * width, 0.0, width);
    return 0.5 * inside * inside / width + max(x - 0.5 * width, 0.0);
}

// The share of a unit square's points with a depth below `x`. Depth is 0 in the middle and changes
// by `wide` along one side and by `narrow` along the other, 0 <= narrow <= wide.
fn share_below(x: f32, wide: f32, narrow: f32) -> f32 {
    if wide < SMALLEST_SLOPE {
        return clamp(x / max(wide, 1e-30) + 0.5, 0.0, 1.0);
    }
    if narrow < SMALLEST_SLOPE {
        return clamp(x / wide + 0.5, 0.0, 1.0);
    }
    let above = ramp_integral(x + 0.5 * narrow, wide);
    return (above - ramp_integral(x - 0.5 * narrow, wide)) / narrow;
}

struct DepthPart {
    share: f32,
    // From the middle of the pixel's range of depth to the middle of the voxel's part of it.
    offset: f32,
}

fn part_of_depth(walk: ptr<function, Walk>) -> DepthPart {
    let voxel = (*walk).voxel;
    let centre = vec2f(voxel.xy) + 0.5;
    let depth = (*walk).a.z + dot((*walk).slope, centre - (*walk).a.xy);
    let slope = abs((*walk).slope);
    let wide = max(slope.x, slope.y);
    let narrow = min(slope.x, slope.y);
    let reach = 0.5 * (wide + narrow);
    let range = (*walk).depth_range;
    let low = clamp(depth - reach, range.x, range.y);
    let high = clamp(depth + reach, range.x, range.y);
    let slab = vec2f(f32(voxel.z), f32(voxel.z) + 1.0);
    let whole = share_below(high - depth, wide, narrow) - share_below(low - depth, wide, narrow);
    if low == high || whole <= 0.0 {
        return DepthPart(select(0.0, 1.0, low >= slab.x && low < slab.y), 0.0);
    }
    let own_low = clamp(slab.x, low, high);
    let own_high = clamp(slab.y, low, high);
    let own = share_below(own_high - depth, wide, narrow) - share_below(own_low - depth, wide, narrow);
    return DepthPart(clamp(own / whole, 0.0, 1.0), 0.5 * (own_low + own_high - low - high));
}

fn share_of_pixel(walk: ptr<function, Walk>) -> Piece {
    let corner = vec3f((*walk).voxel);
    let whole_area = 0.5 * abs((*walk).normal.z);
    let least = min((*walk).a, min((*walk).b, (*walk).c));
    let most = max((*walk).a, max((*walk).b, (*walk).c));
    let box_low = clamp(least, corner, corner + 1.0);
    let box_high = clamp(most, corner, corner + 1.0);
    let is_whole = all(least.xy >= corner.xy) && all(most.xy <= corner.xy + 1.0);

    // Relative to a point near the piece, so that a tiny piece's integrals are sums of tiny
    // numbers.
    let origin = box_low.xy;
    let low = corner.xy - origin;
    let high = low + 1.0;
    let a = (*walk).a.xy - origin;
    let b = (*walk).b.xy - origin;
    let c = (*walk).c.xy - origin;
    let sum = sign((*walk).normal.z)
        * (integrals(a, b, low, high) + integrals(b, c, low, high) + integrals(c, a, low, high));

    // The sums are of terms no larger than the box, each off by a few roundings.
    let box = box_high.xy - box_low.xy;
    var covered = 0.0;
    var uv = 0.5 * (box_low.xy + box_high.xy);
    if is_whole {
        covered = whole_area;
        uv = ((*walk).a.xy + (*walk).b.xy + (*walk).c.xy) / 3.0;
    } else if sum.x > box.x * box.y / 2097152.0 {
        covered = min(min(sum.x, whole_area), 1.0);
        uv = origin + sum.yz / sum.x;
    }
    // Move the point within the plane, straight up or down, to the voxel's part.
    let part = part_of_depth(walk);
    let slope = (*walk).slope;
    uv += slope * (part.offset / max(dot(slope, slope), 1e-30));
    uv = clamp(uv, box_low.xy, box_high.xy);
    let depth = (*walk).a.z + dot(slope, uv - (*walk).a.xy);
    return Piece(covered * part.share, clamp(vec3f(uv, depth), box_low, box_high));
}
