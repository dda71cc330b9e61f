// What this frame gathered beside what earlier ones know, at each traced pixel, for the filter (`filter.wgsl`).

import package::temporal::guide::{pack_guide, NO_SURFACE};
import package::trace::gbuffer::load_surface;
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::voxelize::reproducible::is_finite;

@group(1) @binding(1) var traced: texture_2d<f32>;
@group(1) @binding(2) var recalled_irradiance: texture_2d<f32>;
@group(1) @binding(3) var recalled_specular: texture_2d<f32>;
@group(1) @binding(4) var guide_out: texture_storage_2d<rgba32float, write>;
// Irradiance in rgb; in a the squared difference to what is known, over the sum of both, so that no float overflows.
@group(1) @binding(5) var light_out: texture_storage_2d<rgba16float, write>;
// The difference in rgb, in a whether anything is known.
@group(1) @binding(6) var change_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let place = invocation.xy;
    if any(place >= traced_size()) {
        return;
    }
    let pixel = traced_pixel(place);
    let surface = load_surface(pixel);
    var guide = NO_SURFACE;
    var light = vec4f(0.0);
    var change = vec4f(0.0);
    let gathered = textureLoad(traced, place, 0).rgb;
    // Light that is not a number must not reach the pixels around.
    if surface.depth > 0.0 && is_finite(gathered) {
        guide = pack_guide(surface);
        light = vec4f(gathered, 0.0);
        if textureLoad(recalled_specular, pixel, 0).a != 0.0 {
            let known = textureLoad(recalled_irradiance, pixel, 0).rgb;
            change = vec4f(light.rgb - known, 1.0);
            let difference = dot(abs(change.rgb), vec3f(1.0 / 3.0));
            let sum = dot(abs(light.rgb) + abs(known), vec3f(1.0 / 3.0));
            light.a = difference * difference / max(sum, 1e-20);
        }
    }
    textureStore(guide_out, place, guide);
    textureStore(light_out, place, light);
    textureStore(change_out, place, change);
}
