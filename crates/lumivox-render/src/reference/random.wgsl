// Independent random numbers: every sample of every pixel has a sequence of its own.

import package::gpu::random::hash;

var<private> random_key: u32;
var<private> random_count: u32;

fn start_random(seed: u32, pixel: u32, sample: u32) {
    random_key = hash(pixel ^ hash(sample ^ hash(seed)));
    random_count = 0u;
}

// In [0, 1).
fn random() -> f32 {
    random_count++;
    return f32(hash(random_key ^ hash(random_count)) >> 8u) * (1.0 / 16777216.0);
}

fn random_2() -> vec2f {
    let first = random();
    return vec2f(first, random());
}
