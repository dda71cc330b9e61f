// The keys of planes (planes.wgsl).

import package::voxelize::walk::Walk;

// A plane of a lobe: w = height + dot(slope, uv - 1/2) in walk order, within the voxel.
struct Plane {
    height: f32,
    slope: vec2f,
}

// A plane that passes a voxel has a height from -1 to 2 at its middle, and slopes from -1 to 1.
const HEIGHT_STEPS = 1364.0;
const SLOPE_STEPS = 511.0;

// Parallel planes closer than SAME_HEIGHT, in voxels, are merged. Planes that intersect in the
// voxel, as on curved surface, are merged if their slopes differ by less than the second constant.
const SAME_HEIGHT = 0.004;
const SAME_SLOPE = 0.15;

// The key of a plane, never 0. Planes nearer to the side that the lobe faces have larger keys.
fn key_of(plane: Plane, lobe: u32) -> u32 {
    let steps = u32(round((plane.height + 1.0) * HEIGHT_STEPS));
    let height = 1u + select(steps, 4092u - min(steps, 4092u), (lobe & 1u) != 0u);
    let slope = vec2u(round((plane.slope + 1.0) * SLOPE_STEPS));
    return (height << 20u) | (slope.x << 10u) | slope.y;
}

fn plane_of(key: u32, lobe: u32) -> Plane {
    let height = (key >> 20u) - 1u;
    let steps = select(height, 4092u - height, (lobe & 1u) != 0u);
    let slope = vec2f(vec2u((key >> 10u) & 0x3ffu, key & 0x3ffu));
    return Plane(f32(steps) / HEIGHT_STEPS - 1.0, slope / SLOPE_STEPS - 1.0);
}

// The largest distance between two planes in a voxel.
fn apart(a: Plane, b: Plane) -> f32 {
    let slope = abs(a.slope - b.slope);
    return abs(a.height - b.height) + 0.5 * (slope.x + slope.y);
}

fn is_same(a: u32, b: u32, lobe: u32) -> bool {
    let own = plane_of(a, lobe);
    let other = plane_of(b, lobe);
    let slopes = abs(own.slope - other.slope);
    let apart = abs(own.height - other.height);
    let slope = slopes.x + slopes.y;
    return slope < SAME_SLOPE && apart < SAME_HEIGHT + 0.5 * slope;
}

// The plane of the walk's triangle in the current voxel.
fn plane_of_walk(walk: ptr<function, Walk>) -> Plane {
    let middle = vec2f((*walk).voxel.xy) + 0.5;
    let height = (*walk).a.z + dot((*walk).slope, middle - (*walk).a.xy) - f32((*walk).voxel.z);
    return Plane(clamp(height, -1.0, 2.0), clamp((*walk).slope, vec2f(-1.0), vec2f(1.0)));
}
