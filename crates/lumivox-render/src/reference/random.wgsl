// Random numbers that are evenly spread over the samples of a batch.
//
// A batch of 16 samples uses each 16th of the range once in every dimension, and each cell of a 4 x
// 4 grid for a pair of numbers, in a separate order for each dimension, pixel and batch (jittered
// sampling: Cook, Porter and Carpenter 1984, "Distributed ray tracing"). Each sample is as random
// as without stratification; the mean is less noisy. Batches are independent of each other, so the
// spread of their means gives the noise.

import package::constants::REFERENCE_BATCH;
import package::gpu::random::hash;

var<private> random_key: u32;
// The sample's index in its batch.
var<private> random_place: u32;
var<private> random_count: u32;

fn start_random(seed: u32, pixel: u32, sample: u32) {
    random_key = hash(pixel ^ hash((sample / REFERENCE_BATCH) ^ hash(seed)));
    random_place = sample % REFERENCE_BATCH;
    random_count = 0u;
}

// The key of the next dimension.
fn next_dimension() -> u32 {
    random_count++;
    return hash(random_key ^ hash(random_count));
}

// A permutation of the numbers below 16, given by the key: odd factors, sums and shifts are one to
// one modulo 16.
fn shuffled(place: u32, key: u32) -> u32 {
    var x = place ^ key;
    x = (x * (((key >> 4u) & 14u) | 1u)) & 15u;
    x ^= x >> 2u;
    x = ((x + (key >> 8u)) * (((key >> 12u) & 14u) | 1u)) & 15u;
    x ^= x >> 1u;
    return (x ^ (key >> 16u)) & 15u;
}

// A number in [0, 1), different for each sample.
fn jitter(key: u32) -> f32 {
    return f32(hash(key ^ hash(random_place)) >> 8u) * (1.0 / 16777216.0);
}

// Sums are rounded, and 1 would be out of range.
const BELOW_ONE: f32 = 0.99999994;

// A number in [0, 1).
fn random() -> f32 {
    let key = next_dimension();
    return min((f32(shuffled(random_place, key)) + jitter(key)) / 16.0, BELOW_ONE);
}

// Two numbers in [0, 1).
fn random_2() -> vec2f {
    let key = next_dimension();
    let place = shuffled(random_place, key);
    let corner = vec2f(f32(place & 3u), f32(place >> 2u));
    return min((corner + vec2f(jitter(key), jitter(~key))) / 4.0, vec2f(BELOW_ONE));
}
