// Samples the probes of a traced frame: a different pixel of each 3x3 in each frame.

import package::constants::PROBE_SPACING;
import package::temporal::probe::{probes_size, Probe, NO_PROBE};
import package::trace::gbuffer::load_surface;
import package::trace::screen::{settings, traced_pixel, traced_size, traced_turn};
import package::trace::view::view;

@group(1) @binding(1) var traced: texture_2d<f32>;
@group(1) @binding(2) var<storage, read_write> probes: array<Probe>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let size = probes_size(traced_size());
    if any(invocation.xy >= size) {
        return;
    }
    let index = invocation.y * size.x + invocation.x;
    let turn = view.frame % (PROBE_SPACING * PROBE_SPACING);
    let within = vec2u(turn % PROBE_SPACING, turn / PROBE_SPACING);
    let place = min(PROBE_SPACING * invocation.xy + within, traced_size() - 1u);
    let pixel = traced_pixel(place);
    let surface = load_surface(pixel);
    if surface.depth <= 0.0 || settings.bounces == 0u {
        probes[index].pixel = NO_PROBE;
        return;
    }
    let gathered = textureLoad(traced, place, 0).rgb;
    probes[index] = Probe(
        surface.position_in_world,
        traced_turn(),
        surface.shading_normal,
        pixel.x | (pixel.y << 16u),
        surface.geometric_normal,
        0u,
        gathered,
        0u,
        gathered,
        0u,
    );
}
