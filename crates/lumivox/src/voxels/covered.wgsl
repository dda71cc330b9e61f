// The part of its voxel that a face covers, seen along its lobe's axis (computed in
// voxelize/cover.wgsl).

// Distance beyond its voxel within which a surface is hit, in voxels, so that rounding leaves no
// gaps between neighbours.
const OVERHANG = 0.01;

// The two components across an axis, in cyclic order.
fn across(v: vec3f, axis: u32) -> vec2f {
    return vec2f(v[(axis + 1u) % 3u], v[(axis + 2u) % 3u]);
}

// Whether a face covers a point of the voxel's side.
fn is_covered(at: vec2f, mask: vec2u, profiles: vec4u) -> bool {
    let uv = clamp(at, vec2f(0.0), vec2f(1.0));
    let square = vec2u(min(8.0 * uv, vec2f(7.0)));
    let is_in_mask = (mask[square.y / 4u] >> (8u * (square.y % 4u) + square.x)) & 1u;
    let along = vec4f(uv, 0.5 * (uv.x + uv.y), 0.5 * (uv.x - uv.y) + 0.5);
    let bits = (profiles >> vec4u(min(32.0 * along, vec4f(31.0)))) & vec4u(1u);
    let is_near = all(abs(at - uv) <= vec2f(OVERHANG));
    return is_near && (is_in_mask & bits.x & bits.y & bits.z & bits.w) != 0u;
}
