// Ray-triangle intersection by a traversal of boxes, nearest first.
//
// The loop over boxes and the loop over a leaf's triangles alternate (Aila and Laine 2009,
// "Understanding the efficiency of ray traversal on GPUs"): the lanes of a wide processor then do
// the same work at the same time. The triangle test is Moeller and Trumbore's (1997), widened by
// the resolution of f32, so that no ray slips through the edge that two triangles share.

import package::constants::{
    BLOCKING, BOTH_SIDES, NO_TRIANGLE, REFERENCE_LEAF, REFERENCE_STACK, TRIANGLE_DOUBLE_SIDED,
    TRIANGLE_SEE_THROUGH,
};
import package::render::reference::world::{nodes, triangle_at, world};

struct Ray {
    origin: vec3f,
    // Unit length.
    direction: vec3f,
    reach: f32,
}

struct Hit {
    distance: f32,
    // NO_TRIANGLE if there is no hit.
    triangle: u32,
    // Weights of the second and third vertex.
    weights: vec2f,
    // Whether the ray hits the back of a single-sided surface.
    is_back: bool,
}

// The differences, cross products and dot products behind a weight have up to seven rounding errors
// of 2^-24 each, relative to the input lengths: 4e-7. This is a little more than twice that.
const EDGE_TOLERANCE: f32 = 1e-6;

// The distance at which a ray enters a box; above `reach` if it misses.
fn entry(node: u32, origin: vec3f, inverse: vec3f, reach: f32) -> f32 {
    let a = (nodes[node].low - origin) * inverse;
    let b = (nodes[node].high - origin) * inverse;
    let near = min(a, b);
    let far = max(a, b);
    let first = max(max(near.x, near.y), max(near.z, 0.0));
    // Rounding must not lose triangles that lie in the box's own faces.
    let last = min(min(far.x, far.y), min(far.z, reach)) * 1.0000004;
    return select(3.4e38, first, first <= last);
}

// The nearest triangle that a ray hits; if `stops_early`, any opaque triangle.
fn intersect(ray: Ray, sides: u32, stops_early: bool) -> Hit {
    // Components must not be zero, or products would be undefined.
    let tiny = abs(ray.direction) < vec3f(1e-20);
    let inverse = 1.0 / select(ray.direction, vec3f(1e-20), tiny);
    var hit = Hit(ray.reach, NO_TRIANGLE, vec2f(0.0), false);
    var stack: array<u32, REFERENCE_STACK>;
    var depth = 0u;
    var current = world.root;
    var is_done = false;
    loop {
        while (current & REFERENCE_LEAF) == 0u {
            let left = entry(current, ray.origin, inverse, hit.distance);
            let right = entry(current + 1u, ray.origin, inverse, hit.distance);
            let nearer = select(current, current + 1u, right < left);
            if max(left, right) < 3e38 {
                stack[depth] = nodes[2u * current + 1u - nearer].link;
                depth++;
            }
            if min(left, right) < 3e38 {
                current = nodes[nearer].link;
            } else if depth > 0u {
                depth--;
                current = stack[depth];
            } else {
                is_done = true;
                break;
            }
        }
        if !is_done {
            let first = current & 0x0fffffffu;
            let last = first + ((current >> 28u) & 7u);
            for (var index = first; index <= last; index++) {
                let triangle = triangle_at(index);
                let p = cross(ray.direction, triangle.edge_2);
                // Positive if the ray hits the front.
                let determinant = dot(triangle.edge_1, p);
                let inverse_determinant = 1.0 / determinant;
                let from_corner = ray.origin - triangle.corner;
                let u = dot(from_corner, p) * inverse_determinant;
                let q = cross(from_corner, triangle.edge_1);
                let v = dot(ray.direction, q) * inverse_determinant;
                let distance = dot(triangle.edge_2, q) * inverse_determinant;
                let lengths = sqrt(dot(from_corner, from_corner)
                    * max(dot(triangle.edge_1, triangle.edge_1), dot(triangle.edge_2, triangle.edge_2)));
                let least = -EDGE_TOLERANCE * (1.0 + lengths * abs(inverse_determinant));
                let is_back = determinant <= 0.0 && (triangle.vertex_0 & TRIANGLE_DOUBLE_SIDED) == 0u;
                let counts = !is_back || sides == BOTH_SIDES
                    || (sides == BLOCKING && (triangle.vertex_0 & TRIANGLE_SEE_THROUGH) == 0u);
                // Written so that NaN (from a determinant of zero) is not a hit.
                if counts && u >= least && v >= least && u + v <= 1.0 - least
                    && distance > 0.0 && distance < hit.distance {
                    hit = Hit(distance, index, vec2f(u, v), is_back);
                    is_done = is_done || (stops_early && (triangle.vertex_0 & TRIANGLE_SEE_THROUGH) == 0u);
                }
            }
            is_done = is_done || depth == 0u;
            if !is_done {
                depth--;
                current = stack[depth];
            }
        }
        if is_done {
            break;
        }
    }
    return hit;
}

// A ray from a surface point, offset to a normal's side against rounding errors.
fn ray_from(position: vec3f, side: vec3f, direction: vec3f, reach: f32) -> Ray {
    return Ray(position + side * world.offset_m, direction, reach);
}
