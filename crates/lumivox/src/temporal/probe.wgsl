// A probe: one traced pixel of each 3x3, by which the next frame measures the change of light.

import package::constants::PROBE_SPACING;

struct Probe {
    position_in_world: vec3f,
    // The index in the pixel's jitter sequence.
    turn: u32,
    shading_normal: vec3f,
    // The pixel: x in the lower half, y in the upper; NO_PROBE if nothing was traced.
    pixel: u32,
    geometric_normal: vec3f,
    padding_0: u32,
    // The irradiance that the probe's cones gathered, and that they gather now.
    was: vec3f,
    padding_1: u32,
    now: vec3f,
    padding_2: u32,
}

const NO_PROBE: u32 = 0xffffffffu;

// The size of the table of probes.
fn probes_size(traced_size: vec2u) -> vec2u {
    return (traced_size + PROBE_SPACING - 1u) / PROBE_SPACING;
}
