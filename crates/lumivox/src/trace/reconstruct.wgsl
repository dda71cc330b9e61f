// Makes the picture from traced pixels: each pixel is the weighted mean of the four traced pixels
// around it (`around.wgsl`), or its own value at full resolution. In the first frames it also
// includes the light of adjacent traced pixels. If none of the four fits, the pixel is listed, to
// be traced individually (`edges.wgsl`).

import package::trace::around::{traced_around, FITS};
import package::trace::fit::fit;
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::reflections::{brightness, filter_reflection};
import package::trace::screen::{settings, share_in_mean, traced_pixel, traced_share, traced_size};
import package::trace::surface::Surface;
import package::trace::view::view;
import package::voxelize::reproducible::is_finite;

@group(1) @binding(1) var irradiance_in: texture_2d<f32>;
@group(1) @binding(2) var specular_in: texture_2d<f32>;
@group(1) @binding(3) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(4) var specular_out: texture_storage_2d<rgba16float, write>;
// The number of listed pixels.
@group(1) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
// Pixel indices in row-major order, from the second element on.
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;

// Differences below this multiple of their noise are noise.
const CERTAIN: f32 = 3.0;

// The brightness of 5 x 5 traced pixels around a pixel, and their fit to its surface.
var<private> brightnesses: array<f32, 25>;
var<private> shares: array<f32, 25>;

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
            let place = centre + x + 5 * y;
            rest += part * brightnesses[place];
            least = min(least, shares[place]);
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
        let other = load_surface(traced_pixel(vec2u(place)));
        let between = other.position_in_world - surface.position_in_world;
        let gathered = textureLoad(irradiance_in, place, 0);
        // NaN must not spread to the pixels around.
        let is_light = other.depth > 0.0 && is_finite(gathered.rgb);
        let light = select(vec4f(0.0), gathered, is_light);
        let weight = select(0.0, fit(between, other.shading_normal, surface), is_light);
        brightnesses[i] = brightness(light.rgb);
        shares[i] = weight;
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
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    if surface.depth <= 0.0 {
        textureStore(irradiance_out, pixel, vec4f(0.0, 0.0, 0.0, 1.0));
        textureStore(specular_out, pixel, vec4f(0.0));
        return;
    }
    let around = traced_around(pixel, surface);
    var irradiance = vec4f(0.0);
    var specular = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let weight = around.weights[i];
        if weight > 0.0 {
            irradiance += weight * textureLoad(irradiance_in, around.sources[i], 0);
            specular += weight * textureLoad(specular_in, around.sources[i], 0);
            weights += weight;
        }
    }
    if settings.shares != 0u {
        let share = share_in_mean();
        let centre = pixel / settings.scale;
        irradiance = mix(irradiance, gathered_beside(centre, surface, irradiance), share);
        let material = load_specular(pixel);
        if any(material.reflectance > vec3f(0.0)) || material.coat > 0.0 {
            let filtered = filter_reflection(specular.rgb, share, specular_in, centre, surface, material);
            specular = vec4f(filtered, specular.a);
        }
    }
    specular.a *= traced_share();
    irradiance.a = select(irradiance.a, 1.0, weights <= 0.0);
    textureStore(irradiance_out, pixel, irradiance);
    textureStore(specular_out, pixel, specular);
    if around.best < FITS && settings.bounces > 0u {
        // The order does not matter, since each pixel is traced individually.
        let place = 1u + atomicAdd(&counts[0], 1u);
        if place < arrayLength(&listed) {
            listed[place] = pixel.y * view.size.x + pixel.x;
        }
    }
}
