// Compares this frame's light with the known light at each traced pixel, for the filter
// (`filter.wgsl`).

import package::temporal::guide::{pack_guide, NO_SURFACE};
import package::trace::fit::fit;
import package::trace::gbuffer::load_surface;
import package::trace::guide::{guide_normal, guide_position, is_surface};
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::trace::surface::Surface;
import package::voxelize::reproducible::is_finite;

@group(1) @binding(1) var guides: texture_2d<u32>;
@group(1) @binding(2) var traced: texture_2d<f32>;
@group(1) @binding(3) var recalled_irradiance: texture_2d<f32>;
@group(1) @binding(4) var recalled_specular: texture_2d<f32>;
@group(1) @binding(5) var guide_out: texture_storage_2d<rgba32float, write>;
// Irradiance in rgb. In a, the squared difference to the known light or, if none is known, to the
// pixels beside it, divided by their sum, so that it does not overflow.
@group(1) @binding(6) var light_out: texture_storage_2d<rgba16float, write>;
// Difference to the known light in rgb; 1 in a if there is known light.
@group(1) @binding(7) var change_out: texture_storage_2d<rgba16float, write>;

// Variance of a sample as a share of its expected squared difference from the mean of four others.
const OF_FOUR: f32 = 0.8;

fn noise(light: vec3f, mean: vec3f) -> f32 {
    let difference = dot(abs(light - mean), vec3f(1.0 / 3.0));
    return difference * difference / max(dot(abs(light) + abs(mean), vec3f(1.0 / 3.0)), 1e-20);
}

// Mean light of the four adjacent traced pixels, weighted by their fit to the surface.
fn mean_beside(place: vec2u, surface: Surface) -> vec3f {
    let last = vec2i(traced_size()) - 1;
    var sum = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = vec2i(select(0, 2 * (i & 1) - 1, i < 2), select(0, 2 * (i & 1) - 1, i >= 2));
        let beside = vec2u(clamp(vec2i(place) + offset, vec2i(0), last));
        let guide = textureLoad(guides, beside, 0);
        let gathered = textureLoad(traced, beside, 0).rgb;
        if is_surface(guide) && is_finite(gathered) {
            let between = guide_position(guide) - surface.position_in_world;
            let weight = fit(between, guide_normal(guide), surface);
            sum += weight * gathered;
            weights += weight;
        }
    }
    return sum / max(weights, 1e-6);
}

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
    // NaN must not spread to the pixels around.
    if surface.depth > 0.0 && is_finite(gathered) {
        guide = pack_guide(surface);
        light = vec4f(gathered, 0.0);
        if textureLoad(recalled_specular, pixel, 0).a != 0.0 {
            let known = textureLoad(recalled_irradiance, pixel, 0).rgb;
            change = vec4f(light.rgb - known, 1.0);
            light.a = noise(light.rgb, known);
        } else {
            light.a = OF_FOUR * noise(light.rgb, mean_beside(place, surface));
        }
    }
    textureStore(guide_out, place, guide);
    textureStore(light_out, place, light);
    textureStore(change_out, place, change);
}
