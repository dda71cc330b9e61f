// The settings of passes over the screen, and their mapping from invocations to pixels.

import package::cones::cone::ConeSettings;
import package::trace::view::view;

struct ScreenSettings {
    cones: ConeSettings,
    diffuse_cones: u32,
    // 1 to trace every pixel; 2 for one of each 2x2 block.
    scale: u32,
    specular_share: f32,
    // Number of bounces; 0 for no indirect light.
    bounces: u32,
    // Whether light of earlier frames is available.
    remembers: u32,
    // Whether light or surfaces have changed since the last frame.
    has_changed: u32,
    // Turns of the jitter sequence per frame, for a traced and for an edge pixel (`edges.wgsl`).
    turns: u32,
    edge_turns: u32,
    // Whether the first frames of a mean share the light of pixels and faces.
    shares: u32,
    // Rays to emitters of a traced pixel.
    emitter_rays: u32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> settings: ScreenSettings;

// The pixel of a block that this frame traces, different in each of four frames.
fn traced_pixel(invocation: vec2u) -> vec2u {
    if settings.scale == 1u {
        return invocation;
    }
    let turn = view.frame & 3u;
    let shift = vec2u(u32(turn == 1u || turn == 2u), u32(turn == 1u || turn == 3u));
    return min(settings.scale * invocation + shift, view.size - 1u);
}

// The pixel's index in the jitter sequence: the number of its traces so far. The frame number does
// not work, since every fourth element of the sequence is nearly the same.
fn traced_turn() -> u32 {
    return select(view.frame >> 2u, view.frame, settings.scale == 1u);
}

// Distance between the turns of one frame, so that later frames do not repeat them, chosen so that
// four turns are well distributed in every sequence of a pixel. (The sequence of cones advances by
// 0.743 and 0.299, of emitters by 0.755, of lobes by 0.265.)
const TURNS_APART: u32 = 2510u;

// The share of the pixels that a frame traces.
fn traced_share() -> f32 {
    return 1.0 / f32(settings.scale * settings.scale);
}

// Frame number at which shared light has the weight 1/2.
const SHARED_FRAMES: f32 = 2.0;

// The weight of shared light in this frame of a mean.
fn share_in_mean() -> f32 {
    return SHARED_FRAMES / (SHARED_FRAMES + f32(view.frame));
}

// The size of the textures that cones are traced into.
fn traced_size() -> vec2u {
    return (view.size + settings.scale - 1u) / settings.scale;
}
