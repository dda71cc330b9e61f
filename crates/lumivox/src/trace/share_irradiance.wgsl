// In the first frames of a mean, traced pixels share their irradiance with those around.

import package::trace::fit::fit;
import package::trace::guide::{guide_normal, guide_position, is_surface};
import package::trace::reflections::brightness;
import package::trace::screen::{share_in_mean, traced_pixel, traced_size};
import package::trace::gbuffer::load_surface;
import package::trace::surface::Surface;
import package::voxelize::reproducible::is_finite;

@group(1) @binding(1) var guides: texture_2d<u32>;
@group(1) @binding(2) var irradiance_in: texture_2d<f32>;
@group(1) @binding(3) var irradiance_out: texture_storage_2d<rgba16float, write>;

// Differences below this multiple of their noise are noise.
const CERTAIN: f32 = 3.0;

// The brightness of 5 x 5 traced pixels around a pixel, and their fit to its surface, as half
// floats.
var<private> around: array<u32, 25>;

// The variance of a traced pixel's noise, estimated by a filter that removes uniform areas and
// straight edges (Immerkaer 1996, "Fast noise variance estimation").
fn noise_variance() -> f32 {
    var sum = 0.0;
    var count = 0.0;
    for (var i = 0; i < 9; i++) {
        let centre = 6 + i % 3 + 5 * (i / 3);
        var rest = 0.0;
        var least = 1.0;
        for (var j = 0; j < 9; j++) {
            let x = j % 3 - 1;
            let y = j / 3 - 1;
            let part = f32((2 - 3 * abs(x)) * (2 - 3 * abs(y)));
            let its = unpack2x16float(around[centre + x + 5 * y]);
            rest += part * its.x;
            least = min(least, its.y);
        }
        sum += least * rest * rest / 36.0;
        count += least;
    }
    return sum / max(count, 1e-3);
}

// `difference` without the part that may be noise of this variance (Wiener filter).
fn without_noise(difference: vec4f, variance: f32) -> vec4f {
    let size = brightness(abs(difference.rgb));
    return difference * max(1.0 - CERTAIN * CERTAIN * variance / max(size * size, 1e-20), 0.0);
}

// The mean of 5 x 5 traced pixels, plus the parts above noise of two differences: of the mean of 3
// x 3 pixels to it, and of the pixel itself to that.
fn gathered_beside(centre: vec2u, surface: Surface, own: vec4f) -> vec4f {
    let last = vec2i(traced_size()) - 1;
    var near = vec4f(0.0);
    var near_weight = 0.0;
    var wide = vec4f(0.0);
    var wide_weight = 0.0;
    for (var i = 0; i < 25; i++) {
        let offset = vec2i(i % 5, i / 5) - 2;
        let place = clamp(vec2i(centre) + offset, vec2i(0), last);
        let guide = textureLoad(guides, place, 0);
        let gathered = textureLoad(irradiance_in, place, 0);
        // NaN must not spread to the pixels around.
        let is_light = is_surface(guide) && is_finite(gathered.rgb);
        let light = select(vec4f(0.0), gathered, is_light);
        let between = guide_position(guide) - surface.position_in_world;
        let weight = select(0.0, fit(between, guide_normal(guide), surface), is_light);
        around[i] = pack2x16float(vec2f(brightness(light.rgb), weight));
        wide += weight * light;
        wide_weight += weight;
        if all(abs(offset) < vec2i(2)) {
            near += weight * light;
            near_weight += weight;
        }
    }
    if near_weight < 0.5 {
        return own;
    }
    near /= near_weight;
    wide /= wide_weight;
    let variance = noise_variance();
    return wide + without_noise(near - wide, variance / near_weight) + without_noise(own - near, variance);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let place = invocation.xy;
    if any(place >= traced_size()) {
        return;
    }
    var irradiance = textureLoad(irradiance_in, place, 0);
    let surface = load_surface(traced_pixel(place));
    if surface.depth > 0.0 {
        irradiance = mix(irradiance, gathered_beside(place, surface, irradiance), share_in_mean());
    }
    textureStore(irradiance_out, place, irradiance);
}
