// This frame's light at every pixel: the light gathered around it, blended into the known light.
// The result is the light of the picture, and the known light of the next frame.

import package::temporal::blend::{blend, Fresh, Known};
import package::temporal::record::{encode_record, Record};
import package::trace::around::{traced_around, Around, FITS};
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::screen::{settings, traced_pixel, traced_share, traced_size};
import package::trace::reflections::{blended, unpack_reflections};
import package::trace::surface::Surface;
import package::trace::view::view;
import package::voxelize::reproducible::is_finite;

@group(1) @binding(1) var guides: texture_2d<u32>;
@group(1) @binding(2) var reflections: texture_2d<u32>;
@group(1) @binding(3) var traced_irradiance: texture_2d<f32>;
// Light after the first, second and last step of the filter.
@group(1) @binding(4) var step_1: texture_2d<f32>;
@group(1) @binding(5) var step_2: texture_2d<f32>;
@group(1) @binding(6) var last_step: texture_2d<f32>;
@group(1) @binding(7) var change: texture_2d<f32>;
@group(1) @binding(8) var recalled_irradiance: texture_2d<f32>;
@group(1) @binding(9) var recalled_specular: texture_2d<f32>;
@group(1) @binding(10) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(11) var specular_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(12) var records_out: texture_storage_2d<rg32uint, write>;
@group(1) @binding(13) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(14) var<storage, read_write> listed: array<u32>;

// Maximum frames in the mean of a reflection on a rough surface, seen by a moving camera.
const GLOSSY_FRAMES: f32 = 16.0;
// Reflections on surfaces smoother than this show edges, which may move if objects in the scene do.
const SHARP_ROUGHNESS: f32 = 0.35;
// Maximum difference of a plausible reflection from those around, in standard deviations.
const PLAUSIBLE: f32 = 1.5;

// Maximum distance of the pixel's center from the sampled point, divided by its distance to the
// camera.
const MOST_MOVED: f32 = 0.1;

// Number of frames from which the reflections around a pixel only take its rare bright hits.
const FILTERED_REFLECTIONS: f32 = 32.0;

// The known reflection, clamped to the range of this frame's reflections around it.
fn plausible(known: vec3f, centre: vec2u) -> vec3f {
    var mean = vec3f(0.0);
    var square = vec3f(0.0);
    let last = vec2i(traced_size()) - 1;
    for (var i = 0; i < 9; i++) {
        let offset = vec2i(i % 3 - 1, i / 3 - 1);
        let place = clamp(vec2i(centre) + offset, vec2i(0), last);
        let value = unpack_reflections(textureLoad(reflections, place, 0)).own;
        mean += value / 9.0;
        square += value * value / 9.0;
    }
    let spread = PLAUSIBLE * sqrt(max(square - mean * mean, vec3f(0.0)));
    return clamp(known, mean - spread, mean + spread);
}

// This frame's reflection blended into the known one, in rgb; the cone samples in a.
fn blend_specular(pixel: vec2u, surface: Surface, around: Around, known: vec4f, frames: f32) -> vec4f {
    var fresh = vec4f(0.0);
    let share = max(1.0 - max(frames, 0.0) / FILTERED_REFLECTIONS, 0.0);
    for (var i = 0; i < 4; i++) {
        if around.weights[i] > 0.0 {
            let filtered = unpack_reflections(textureLoad(reflections, around.sources[i], 0));
            fresh += around.weights[i] * blended(filtered, share);
        }
    }
    fresh.a *= traced_share();
    let roughness = load_specular(pixel).roughness;
    if known.a == 0.0 {
        return fresh;
    }
    // If the place of the mirror image in the last frame is uncertain, smooth surfaces keep little.
    let most = select(1e4, GLOSSY_FRAMES * smoothstep(0.05, 0.4, roughness), known.a < 0.0);
    var past = known.rgb;
    if known.a < 0.0 || (settings.has_changed != 0u && roughness < SHARP_ROUGHNESS) {
        past = plausible(past, around.sources[0]);
    }
    let weight = 1.0 / (min(frames, most) + 1.0);
    return vec4f(mix(past, fresh.rgb, weight), fresh.a);
}

// The point of a pixel's plane at the pixel's center, since the next frame has another jitter.
fn middle_of(pixel: vec2u, surface: Surface) -> vec3f {
    let uv = (vec2f(pixel) + 0.5 + view.jitter) / vec2f(view.size);
    let far = view.world_from_clip * vec4f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y, 0.0, 1.0);
    let ray = far.xyz - far.w * view.position_in_world;
    let to_surface = surface.position_in_world - view.position_in_world;
    let share = dot(to_surface, surface.geometric_normal) / dot(ray, surface.geometric_normal);
    let middle = share * ray;
    let moved = distance(middle, to_surface) / length(to_surface);
    // At a silhouette the plane may not extend there. The comparison is also false for NaN.
    return select(surface.position_in_world, view.position_in_world + middle, moved < MOST_MOVED);
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
        textureStore(records_out, pixel, vec4u(0u));
        return;
    }
    let around = traced_around(pixel, surface, guides);
    let is_alone = around.best < FITS;
    let frames = select(1.0, 0.0, is_alone);
    var fresh = Fresh(vec4f(0.0), vec3f(0.0), vec3f(0.0), vec3f(0.0), 0.0, frames, vec4f(0.0));
    for (var i = 0; i < 4; i++) {
        let weight = around.weights[i];
        if weight > 0.0 {
            let source = around.sources[i];
            let gathered = textureLoad(traced_irradiance, source, 0);
            if !is_finite(gathered.rgb) {
                fresh.frames = 0.0;
                continue;
            }
            let filtered = textureLoad(last_step, source, 0);
            fresh.irradiance += weight * gathered;
            fresh.first += weight * textureLoad(step_1, source, 0).rgb;
            fresh.second += weight * textureLoad(step_2, source, 0).rgb;
            fresh.wide += weight * filtered.rgb;
            fresh.noise += weight * filtered.a;
            fresh.change += weight * textureLoad(change, source, 0);
        }
    }
    let recalled = textureLoad(recalled_specular, pixel, 0);
    let known = Known(textureLoad(recalled_irradiance, pixel, 0), abs(recalled.a));
    if is_alone && settings.bounces > 0u && known.frames <= 0.0 {
        // The order does not matter, since each pixel is traced individually.
        let place = 1u + atomicAdd(&counts[0], 1u);
        if place < arrayLength(&listed) {
            listed[place] = pixel.y * view.size.x + pixel.x;
        }
    }
    var blended = blend(known, fresh);
    var specular = blend_specular(pixel, surface, around, recalled, blended.frames - 1.0);
    if !is_finite(blended.irradiance.rgb) || !is_finite(specular.rgb) {
        // Discard the light.
        blended = Known(vec4f(0.0, 0.0, 0.0, 1.0), 0.0);
        specular = vec4f(0.0);
    }
    textureStore(irradiance_out, pixel, blended.irradiance);
    textureStore(specular_out, pixel, specular);
    // The depth in clip space, independent of the G-buffer's own depth.
    let clip = view.clip_from_world * vec4f(middle_of(pixel, surface), 1.0);
    let is_new = known.frames <= 0.0;
    let record = Record(clip.z / clip.w, surface.shading_normal, blended.frames, is_new);
    textureStore(records_out, pixel, vec4u(encode_record(record), 0u, 0u));
}
