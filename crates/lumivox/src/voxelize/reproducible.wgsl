// Products and sums whose rounding does not depend on the kernel.
//
// A compiler may or may not fuse `a * b + c` into one rounding, and may decide differently for two
// kernels that share a function. Values on which several kernels must agree (which columns a
// triangle covers, which way it faces) are therefore computed with explicit `fma`, which leaves
// nothing to fuse.

fn dot_fused(a: vec3f, b: vec3f) -> f32 {
    return fma(a.x, b.x, fma(a.y, b.y, a.z * b.z));
}

fn cross_fused(a: vec3f, b: vec3f) -> vec3f {
    return fma(a.yzx, b.zxy, -(a.zxy * b.yzx));
}

// Read from the bits, because a compiler may assume that no number is infinite or NaN.
fn is_finite(v: vec3f) -> bool {
    let exponents = bitcast<vec3u>(v) & vec3u(0x7f800000u);
    return all(exponents != vec3u(0x7f800000u));
}
