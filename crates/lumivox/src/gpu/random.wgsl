// Stateless random numbers, the same on every device.

// PCG hash: Jarzynski and Olano 2020, "Hash functions for GPU rendering", JCGT 9 (3), section 3.
fn hash(value: u32) -> u32 {
    let state = value * 747796405u + 2891336453u;
    let word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
    return (word >> 22u) ^ word;
}

// Two numbers in [0, 1) from a seed of two words.
fn random_pair(a: u32, b: u32) -> vec2f {
    let first = hash(a ^ hash(b));
    let second = hash(first);
    return vec2f(f32(first >> 8u), f32(second >> 8u)) * (1.0 / 16777216.0);
}

// The additive recurrence with the lowest discrepancy in two dimensions: Roberts 2018, "The
// unreasonable effectiveness of quasirandom sequences". `start` is the offset of a pixel's
// sequence.
fn sequence_pair(start: vec2f, index: u32) -> vec2f {
    return fract(start + fract(vec2f(0.7548776662, 0.5698402909) * f32(index & 0xffffu)));
}
