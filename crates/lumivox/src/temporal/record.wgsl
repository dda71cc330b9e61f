// What is remembered of a pixel's surface, in two words: its depth in clip space, its normal, and how many frames its
// light is the mean of.

import package::trace::surface::{octahedral_decode, octahedral_encode};

struct Record {
    depth: f32,
    normal: vec3f,
    // 0 where there was no surface.
    frames: f32,
}

// The most frames that are counted.
const MOST_FRAMES: f32 = 4095.0;

// Normals have two coordinates of 10 bits: some 0.2 degrees.
const STEPS: f32 = 1023.0;

fn encode_record(record: Record) -> vec2u {
    let place = vec2u(round((0.5 + 0.5 * octahedral_encode(record.normal)) * STEPS));
    let frames = u32(round(clamp(record.frames, 0.0, MOST_FRAMES)));
    return vec2u(bitcast<u32>(record.depth), place.x | (place.y << 10u) | (frames << 20u));
}

fn decode_record(words: vec2u) -> Record {
    let place = vec2f(vec2u(words.y, words.y >> 10u) & vec2u(1023u)) / STEPS;
    return Record(bitcast<f32>(words.x), octahedral_decode(2.0 * place - 1.0), f32(words.y >> 20u));
}
