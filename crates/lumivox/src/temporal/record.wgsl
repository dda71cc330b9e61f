// Record of a pixel's surface, in two words: its depth in clip space, its normal, the number of
// frames in the mean of its light, and whether the surface is newly seen.

import package::trace::surface::{octahedral_decode, octahedral_encode};

struct Record {
    depth: f32,
    normal: vec3f,
    // Number of frames in the mean; 0 without surface.
    frames: f32,
    // Whether earlier frames had no light for the surface.
    is_new: bool,
}

// Maximum frame count, in 11 bits; the half floats in which it is recalled are hardly exact beyond.
const MOST_FRAMES: f32 = 2047.0;

// Steps of a normal's two coordinates, 10 bits each: about 0.2 degrees.
const NORMAL_STEPS: f32 = 1023.0;

fn encode_record(record: Record) -> vec2u {
    let place = vec2u(round((0.5 + 0.5 * octahedral_encode(record.normal)) * NORMAL_STEPS));
    let frames = u32(round(clamp(record.frames, 0.0, MOST_FRAMES)));
    let count = (frames << 20u) | select(0u, 1u << 31u, record.is_new);
    return vec2u(bitcast<u32>(record.depth), place.x | (place.y << 10u) | count);
}

fn decode_record(words: vec2u) -> Record {
    let place = vec2f(vec2u(words.y, words.y >> 10u) & vec2u(1023u)) / NORMAL_STEPS;
    let frames = f32((words.y >> 20u) & 2047u);
    let is_new = (words.y >> 31u) != 0u;
    return Record(bitcast<f32>(words.x), octahedral_decode(2.0 * place - 1.0), frames, is_new);
}
