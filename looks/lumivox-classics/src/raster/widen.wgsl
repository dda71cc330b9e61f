// Conservative rasterization without hardware for it: a triangle whose edges are shifted outwards
// covers the centre of every pixel that the triangle itself touches (Hasselgren, Akenine-Möller and
// Ohlsson 2005, "Conservative rasterization", GPU Gems 2, chapter 42; Crassin and Green 2012,
// OpenGL Insights, chapter 22). At acute corners it covers more, which fragments cut off at the
// triangle's box.

import package::voxelize::footprint::Footprint;

// Half a pixel, plus a margin: rasterizers round corners to at least 4 bits below the pixel, by up
// to 1/32 along u and v; twice that is added. Pixels added by the margin fail the fragments' own
// test of the edges.
const HALF_PIXEL = 0.5 + 1.0 / 16.0;

// Farther out than this, in voxels, a corner is clipped with rounding errors of more than 2^-11
// voxels. The edges of a sliver meet that far out when they are shifted.
const FARTHEST = 4096.0;

struct ShiftedCorner {
    position: vec2f,
    is_near: bool,
}

// The corner `here` between two edges, shifted with them. `cross` is twice the triangle's area,
// with its sign.
fn shifted(before: vec2f, here: vec2f, after: vec2f, cross: f32) -> ShiftedCorner {
    let enter = (here - before) * sign(cross);
    let leave = (after - here) * sign(cross);
    // Outward normals m of the two edges. The shifted edges are m . (p - here) = reach.
    let m = vec2f(enter.y, -enter.x);
    let n = vec2f(leave.y, -leave.x);
    let reach_m = HALF_PIXEL * (abs(m.x) + abs(m.y));
    let reach_n = HALF_PIXEL * (abs(n.x) + abs(n.y));
    let position = here + vec2f(reach_m * n.y - reach_n * m.y, reach_n * m.x - reach_m * n.x) / cross;
    // A bound of the shift, without a division by nearly zero.
    let bound = reach_m * (abs(n.x) + abs(n.y)) + reach_n * (abs(m.x) + abs(m.y));
    let is_near = bound < 1e30 && bound < FARTHEST * abs(cross) && max(abs(here.x), abs(here.y)) < FARTHEST;
    return ShiftedCorner(position, is_near);
}

// One of the corners, by its number, of a triangle that covers the centres of all pixels that a, b,
// c touches.
fn widened(a: vec2f, b: vec2f, c: vec2f, area: Footprint, number: u32) -> vec2f {
    let shifted_a = shifted(c, a, b, area.normal.z);
    let shifted_b = shifted(a, b, c, area.normal.z);
    let shifted_c = shifted(b, c, a, area.normal.z);
    if shifted_a.is_near && shifted_b.is_near && shifted_c.is_near {
        let other = select(shifted_c.position, shifted_b.position, number == 1u);
        return select(other, shifted_a.position, number == 0u);
    }
    // All pixels of the box: a right triangle with legs of twice the box's edges contains it.
    // Fragments test which pixels are touched.
    let low = vec2f(area.first.xy) - 1.0;
    let size = vec2f(area.last.xy - area.first.xy) + 3.0;
    return low + 2.0 * size * vec2f(f32(number == 1u), f32(number == 2u));
}
