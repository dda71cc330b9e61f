// One traced pixel of each 3x3, by which the next frame finds out how the light has changed.

struct Probe {
    position_in_world: vec3f,
    // The place in the sequence of its jitter.
    turn: u32,
    shading_normal: vec3f,
    // The pixel: x, and y in the upper half; NO_PROBE where nothing was traced.
    pixel: u32,
    geometric_normal: vec3f,
    padding_0: u32,
    // The irradiance that the probe's cones gathered, and that the very same cones gather now.
    was: vec3f,
    padding_1: u32,
    now: vec3f,
    padding_2: u32,
}

const NO_PROBE: u32 = 0xffffffffu;

// Traced pixels between probes.
const SPACING: u32 = 3u;

// The size of the table of probes.
fn probes_size(traced_size: vec2u) -> vec2u {
    return (traced_size + SPACING - 1u) / SPACING;
}
