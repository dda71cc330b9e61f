// Reflections of surfaces and of traced pixels.

import package::trace::view::view;

// Narrower lobes show the light of points, not of faces: up to a roughness of 0.3.
const SHARP_ALPHA: f32 = 0.09;

// The light of a surface in a mirror.
struct Shown {
    // Its reflected radiance.
    radiance: vec3f,
    // The share of the light from the mirrored direction that comes in addition, and its normal.
    mirrored: vec3f,
    normal: vec3f,
}

// The reflection of a traced pixel in two forms (share_reflections.wgsl).

struct Reflections {
    // The pixel's own, without the part that one ray hit by chance.
    own: vec3f,
    // The mean over pixels around.
    wide: vec3f,
    // Number of cone samples.
    samples: f32,
}

fn brightness(light: vec3f) -> f32 {
    return dot(light, vec3f(1.0 / 3.0));
}

fn pack_reflections(reflections: Reflections) -> vec4u {
    return vec4u(
        pack2x16float(reflections.own.rg),
        pack2x16float(vec2f(reflections.own.b, reflections.samples)),
        pack2x16float(reflections.wide.rg),
        pack2x16float(vec2f(reflections.wide.b, 0.0)),
    );
}

fn unpack_reflections(packed: vec4u) -> Reflections {
    let blue_and_samples = unpack2x16float(packed.y);
    return Reflections(
        vec3f(unpack2x16float(packed.x), blue_and_samples.x),
        vec3f(unpack2x16float(packed.z), unpack2x16float(packed.w).x),
        blue_and_samples.y,
    );
}

// Frame number at which reflections of the pixels around have the weight 1/2: for a mirror, and
// added for each alpha. The wider a lobe, the more of it the pixels around share.
const SHARED_FRAMES: f32 = 2.0;
const SHARED_FRAMES_OF_ALPHA: f32 = 80.0;
// The frame of a mean from which on pixels share no reflections.
const LAST_SHARED_FRAME: f32 = 64.0;

// The weight of reflections of the pixels around in this frame of a mean.
fn share_of_reflections(alpha: f32) -> f32 {
    let frames = SHARED_FRAMES + SHARED_FRAMES_OF_ALPHA * alpha;
    return frames / (frames + f32(view.frame)) * saturate(1.0 - f32(view.frame) / LAST_SHARED_FRAME);
}

// The reflection in rgb, the samples in a; `share` is the weight of the mean over pixels around.
fn blended(reflections: Reflections, share: f32) -> vec4f {
    return vec4f(mix(reflections.own, reflections.wide, share), reflections.samples);
}
