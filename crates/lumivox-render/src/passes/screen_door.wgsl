// Order-independent transparency: a surface that covers a share of its pixel exists with that
// probability, and is then opaque (Enderton et al. 2010, "Stochastic transparency", IEEE TVCG 17
// (8)). The mean over frames, or over the texels of a shadow map's filter, equals blending in the
// correct order.
//
// Surfaces behind each other in a pixel must be drawn independently, or two half-covering panes
// would let half the light through instead of a quarter. So every surface has its own sequence: van
// der Corput's over the frames, shuffled (Burley 2020, "Practical hash-based Owen scrambling", JCGT
// 9 (4)), which is evenly spread over any 2^n frames. Its values are not scrambled, so that of 16
// frames a surface exists in the nearest number below or above its share. All pixels share it,
// rotated by a pattern that also spreads neighbouring pixels evenly (interleaved gradient noise:
// Jimenez 2014, "Next generation post processing in Call of Duty: Advanced Warfare"). A number for
// each tile of 4x4 pixels further rotates the pattern of a surface: even in a single frame two
// half-covering panes then let one quarter through (+-0.02 over 32x32 pixels, against +-0.14 with
// one pattern for all), with slightly more noise within 3x3 pixels (0.09; 0.06 with one pattern,
// 0.17 with random numbers).

import package::gpu::random::hash;

fn laine_karras(value: u32, seed: u32) -> u32 {
    var x = value + seed;
    x ^= x * 0x6c50b47cu;
    x ^= x * 0xb82f1e52u;
    x ^= x * 0xc7afe638u;
    x ^= x * 0x8d22f6e6u;
    return x;
}

fn gradient_noise(pixel: vec2u) -> f32 {
    // 0.06711056 and 0.00583715, in units of 2^-32: integers wrap around exactly.
    let turn = pixel.x * 288237661u + pixel.y * 25070368u;
    return fract(52.9829189 * f32(turn >> 8u) / 16777216.0);
}

// A seed for the surface of a fragment: from its draw, its side, and its distance to 1 part in 256,
// so that pieces of one mesh behind each other get different seeds.
fn surface_seed(draw: u32, is_front: bool, distance: f32) -> u32 {
    return hash(bitcast<u32>(distance) >> 15u) ^ hash(2u * draw + u32(is_front));
}

// Whether a surface that covers a share of a pixel exists in a frame.
fn is_there(coverage: f32, pixel: vec2u, seed: u32, frame: u32) -> bool {
    let step = laine_karras(reverseBits(frame), seed);
    let tile = pixel / 4u;
    let turn = step + hash(tile.x ^ hash(tile.y ^ seed));
    return fract(f32(turn >> 8u) / 16777216.0 + gradient_noise(pixel)) < coverage;
}
