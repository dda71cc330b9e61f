// What a conservative fragment stands for in one voxel of its column.
//
// That a pixel is touched does not say how much of it is covered; counting it as a whole would let a triangle
// that touches a corner weigh as much as one that fills the voxel. The covered area and its centroid follow from
// the boundary integrals of piece.wgsl, without the cut to a slab of depth. Each voxel of the column then gets
// the share that it has of the range of depth. So the areas of a triangle's fragments add up to its own, and a
// voxel that only the range of depth reaches gets a little that is not its.

import package::voxelize::piece::{Piece, integrals};
import package::voxelize::walk::Walk;

fn share_of_depth(walk: ptr<function, Walk>) -> f32 {
    let voxel = (*walk).voxel;
    let centre = vec2f(voxel.xy) + 0.5;
    let depth = (*walk).a.z + dot((*walk).slope, centre - (*walk).a.xy);
    let reach = 0.5 * (abs((*walk).slope.x) + abs((*walk).slope.y));
    let range = (*walk).depth_range;
    let low = clamp(depth - reach, range.x, range.y);
    let high = clamp(depth + reach, range.x, range.y);
    let floor_of_voxel = f32(voxel.z);
    if low == high {
        return select(0.0, 1.0, floor(low) == floor_of_voxel);
    }
    let inside = min(high, floor_of_voxel + 1.0) - max(low, floor_of_voxel);
    return clamp(inside / (high - low), 0.0, 1.0);
}

fn share_of_pixel(walk: ptr<function, Walk>) -> Piece {
    let corner = vec3f((*walk).voxel);
    let whole_area = 0.5 * abs((*walk).normal.z);
    let least = min((*walk).a, min((*walk).b, (*walk).c));
    let most = max((*walk).a, max((*walk).b, (*walk).c));
    let box_low = clamp(least, corner, corner + 1.0);
    let box_high = clamp(most, corner, corner + 1.0);
    let is_whole = all(least.xy >= corner.xy) && all(most.xy <= corner.xy + 1.0);

    // Relative to a point near the piece: the integrals of a tiny piece are then sums of tiny numbers.
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
    let depth = (*walk).a.z + dot((*walk).slope, uv - (*walk).a.xy);
    let centroid = clamp(vec3f(uv, depth), box_low, box_high);
    return Piece(covered * share_of_depth(walk), centroid);
}
