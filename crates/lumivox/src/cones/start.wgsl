// Moves starts of cones away from walls that would be sampled wrongly there.
//
// A wall affects samples within one voxel of the middle of its cells. A cone that starts within
// that reach counts a part of the wall wrongly:
//
// - of a wall beside it, a part of the coverage is behind the start, and light from beyond leaks:
//   the next room made a floor along a wall of 5 mm up to ten times too bright;
// - of the back of its own wall, if both sides are in one voxel, a part is in front of the start:
//   the cone sees light of the other side.
//
// Across a wall of full coverage the filter is a tent, so the sampled coverage gives the distance
// to its end. The tent is centred on the wall's cells, and the wall can be anywhere in them: a
// start between the two is in front of the wall but beyond the middle. The way out is then to the
// wall's visible side. If both are visible, the surface below the start decides: a floor ends at
// the wall and continues on the start's side.

import package::volume::wall_coverage;

// The axis of the largest component: walls are in the lobes of that axis.
fn main_axis(normal: vec3f) -> u32 {
    let size = abs(normal);
    return select(select(2u, 1u, size.y >= size.z), 0u, size.x >= size.y && size.x >= size.z);
}

// Minimum increase of coverage that is significant.
const NOTICEABLE: f32 = 0.25;

// The distance along an axis to where a wall no longer affects samples, given the samples of its
// positive and its negative side, their increase along the axis, and the increase of the start's
// own surface.
fn way_out(here: vec2f, rise: f32, own_rise: f32) -> f32 {
    let felt = max(here.x, here.y);
    let is_one_sided = 2.0 * min(here.x, here.y) < felt;
    let continues = select(0.0, own_rise, abs(own_rise) > NOTICEABLE);
    let outwards = sign(select(continues, here.x - here.y, is_one_sided));
    // A wall is within half a voxel of the middle of its cells; one farther away is behind it.
    if outwards != 0.0 && rise * outwards >= 0.0 && felt > 0.5 {
        return outwards * (2.0 - felt);
    }
    // Away from the side with more coverage.
    return -sign(rise) * felt;
}

// Moves a start above a surface, in the grid's coordinates, out of the reach of such walls. `level`
// is the level of the surface's voxels.
fn clear_of_walls(start: vec3f, normal: vec3f, level: u32) -> vec3f {
    let voxel = exp2(f32(level));
    let own_axis = main_axis(normal);
    var beside = vec3f(0.0);
    var back = 0.0;
    for (var axis = 0u; axis < 3u; axis++) {
        let here = wall_coverage(start, level, axis);
        var half_voxel = vec3f(0.0);
        half_voxel[axis] = 0.5 * voxel;
        let above = wall_coverage(start + half_voxel, level, axis);
        let below = wall_coverage(start - half_voxel, level, axis);
        let own_above = wall_coverage(start + half_voxel, level, own_axis);
        let own_below = wall_coverage(start - half_voxel, level, own_axis);
        let own_rise = max(own_above.x, own_above.y) - max(own_below.x, own_below.y);
        beside[axis] = way_out(here, max(above.x, above.y) - max(below.x, below.y), own_rise);
        let opposite = select(here.x, here.y, normal[axis] > 0.0);
        back = select(back, opposite, axis == own_axis);
    }
    return start + voxel * (beside - normal * dot(beside, normal) + normal * back);
}
