// What the passes over the screen share: the settings, and the pixel that an invocation stands for.

import package::cones::cone::ConeSettings;
import package::trace::view::view;

struct ScreenSettings {
    cones: ConeSettings,
    diffuse_cones: u32,
    // 1: every pixel; 2: one of each 2x2 block.
    scale: u32,
    specular_share: f32,
    // 0: no indirect light at all.
    bounces: u32,
    // Whether earlier frames' light is there to be recalled.
    remembers: u32,
    // Whether light or surfaces have changed since.
    has_changed: u32,
    // How many turns of their sequences a frame traces of a pixel, and of one that it lists (`edges.wgsl`).
    turns: u32,
    listed_turns: u32,
    // Whether pixels share what they have gathered.
    shares: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

@group(1) @binding(0) var<uniform> settings: ScreenSettings;

// The pixel of a block that this frame traces: a different one in each of four frames.
fn traced_pixel(invocation: vec2u) -> vec2u {
    if settings.scale == 1u {
        return invocation;
    }
    let turn = view.frame & 3u;
    let shift = vec2u(u32(turn == 1u || turn == 2u), u32(turn == 1u || turn == 3u));
    return min(settings.scale * invocation + shift, view.size - 1u);
}

// How often this pixel's block has traced it before: its place in the sequence of its jitter. The frame itself would not do, since
// every fourth number of that sequence is nearly the same.
fn traced_turn() -> u32 {
    return select(view.frame >> 2u, view.frame, settings.scale == 1u);
}

// The turns of one frame are far apart, so that those of the next ones are new: so far that four of them are spread well over all
// sequences of a place. (The sequence of cones goes on by 0.743 and 0.299, of emitters by 0.755, of lobes by 0.265.)
const TURNS_APART: u32 = 2510u;

// The share of the pixels that a frame traces.
fn traced_share() -> f32 {
    return 1.0 / f32(settings.scale * settings.scale);
}

// The size of the textures that cones are traced into.
fn traced_size() -> vec2u {
    return (view.size + settings.scale - 1u) / settings.scale;
}
