// The hemisphere divided into cells of equal cosine weight, one cone for each.
//
// With s = sin^2(theta), equal steps of s and of phi have equal cosine weight (Malley's method). 6,
// 9, 12 or 16 cells form two rings: 1 + 5, 3 + 6, 4 + 8, 5 + 11. A cell of solid angle
// W = 2 pi (cos t0 - cos t1) / m is replaced by a round cone of the same solid angle:
// cos(half angle) = 1 - W / (2 pi).

import package::gpu::random::sequence_pair;

struct CellCone {
    // The direction in the frame whose z is the normal; unit length.
    direction: vec3f,
    tan_half_angle: f32,
}

fn inner_ring(cell_count: u32) -> u32 {
    return select(cell_count / 3u, 1u, cell_count == 6u);
}

// The cone of a cell; `jitter` in [0, 1)^2 is the position in the cell.
fn cell_cone(cell: u32, cell_count: u32, jitter: vec2f) -> CellCone {
    let inner = inner_ring(cell_count);
    let split = f32(inner) / f32(cell_count);
    let is_inner = cell < inner;
    let ring_size = select(cell_count - inner, inner, is_inner);
    let index = select(cell - inner, cell, is_inner);
    let s_low = select(split, 0.0, is_inner);
    let s_high = select(1.0, split, is_inner);

    let s = mix(s_low, s_high, jitter.x);
    let phi = 6.28318530718 * (f32(index) + jitter.y) / f32(ring_size);
    let sine = sqrt(s);
    let direction = vec3f(sine * cos(phi), sine * sin(phi), sqrt(1.0 - s));

    let cos_half = 1.0 - (sqrt(1.0 - s_low) - sqrt(1.0 - s_high)) / f32(ring_size);
    let tan_half_angle = sqrt(1.0 - cos_half * cos_half) / cos_half;
    return CellCone(direction, tan_half_angle);
}

// Columns: two tangents and the normal. Duff et al. 2017, "Building an orthonormal basis,
// revisited".
fn basis(normal: vec3f) -> mat3x3f {
    let side = select(-1.0, 1.0, normal.z >= 0.0);
    let a = -1.0 / (side + normal.z);
    let b = normal.x * normal.y * a;
    return mat3x3f(
        vec3f(1.0 + side * normal.x * normal.x * a, side * b, -side * normal.x),
        vec3f(b, side + normal.y * normal.y * a, -normal.y),
        normal,
    );
}

// The position in its cell of each cone of a point in a frame, from the point's own sequence: the
// same for all cells.
fn cell_jitter(start: vec2f, frame: u32) -> vec2f {
    return sequence_pair(start, frame);
}
