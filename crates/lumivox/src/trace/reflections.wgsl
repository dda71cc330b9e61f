// Filter for traced reflections.

import package::trace::fit::fit;
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::screen::{traced_pixel, traced_size};
import package::trace::surface::{Specular, Surface};
import package::voxelize::reproducible::is_finite;

// The reflections of 5 x 5 traced pixels around a pixel, and their weights.
var<private> reflected: array<vec3f, 25>;
var<private> weights: array<f32, 25>;

// Multiple of the typical reflection around above which the excess is spread over all pixels
// around: one pixel's ray has hit by chance a light that all of them reflect.
const TYPICAL: f32 = 2.0;

fn brightness(light: vec3f) -> f32 {
    return dot(light, vec3f(1.0 / 3.0));
}

// The part of a reflection that is above a limit.
fn above(light: vec3f, limit: f32) -> vec3f {
    return light * max(1.0 - limit / max(brightness(light), 1e-20), 0.0);
}

// Blends a pixel's own reflection with those of 5 x 5 traced pixels in this frame, weighted by
// their fit to the surface and the overlap of their lobes: more if the surface is rougher. `share`
// is the weight of the filtered reflection.
fn filter_reflection(
    own: vec3f,
    share: f32,
    reflections: texture_2d<f32>,
    centre: vec2u,
    surface: Surface,
    material: Specular,
) -> vec3f {
    let alpha = max(material.roughness * material.roughness, 1e-3);
    let last = vec2i(traced_size()) - 1;
    var sum = vec3f(0.0);
    var roots = 0.0;
    var all = 0.0;
    for (var i = 0; i < 25; i++) {
        let step = vec2i(i % 5, i / 5) - 2;
        let place = clamp(vec2i(centre) + step, vec2i(0), last);
        let pixel = traced_pixel(vec2u(place));
        let other = load_surface(pixel);
        let its = load_specular(pixel);
        let offset = other.position_in_world - surface.position_in_world;
        let bend = 1.0 - dot(other.shading_normal, surface.shading_normal);
        let unlike = dot(abs(its.reflectance - material.reflectance), vec3f(1.0))
            + abs(its.roughness - material.roughness);
        let spread = f32(dot(step, step)) / (16.0 * alpha + 0.1);
        let weight = fit(offset, other.geometric_normal, surface)
            * exp(-4.0 * bend / (alpha * alpha) - 10.0 * unlike - spread);
        let light = textureLoad(reflections, place, 0).rgb;
        // NaN must not spread to the pixels around.
        let is_light = other.depth > 0.0 && is_finite(light);
        reflected[i] = select(vec3f(0.0), light, is_light);
        weights[i] = select(0.0, weight, is_light);
        sum += weights[i] * reflected[i];
        roots += weights[i] * sqrt(max(brightness(reflected[i]), 0.0));
        all += weights[i];
    }
    if all < 1e-3 {
        return own;
    }
    let root = roots / all;
    let limit = TYPICAL * root * root;
    var shared_light = vec3f(0.0);
    for (var i = 0; i < 25; i++) {
        shared_light += weights[i] * above(reflected[i], limit);
    }
    return mix(own - above(own, limit) + shared_light / all, sum / all, share);
}
