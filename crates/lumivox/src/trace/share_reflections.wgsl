// Removes noise from the reflections of the glossy tiles' pixels (`glossy.wgsl`): each shares light
// with those around.

import package::trace::fit::fit;
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::glossy::{place_in_tile, reflects, TILE};
import package::trace::guide::{guide_normal, guide_position, is_surface};
import package::trace::reflections::{brightness, pack_reflections, Reflections};
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::trace::surface::{Specular, Surface};
import package::voxelize::reproducible::is_finite;

@group(1) @binding(1) var guides: texture_2d<u32>;
@group(1) @binding(2) var specular_in: texture_2d<f32>;
@group(1) @binding(3) var reflections_out: texture_storage_2d<rgba32uint, write>;
// The number of glossy tiles, followed by their indices.
@group(1) @binding(4) var<storage, read> glossy_tiles: array<u32>;

// Multiple of the typical reflection around above which the excess is spread over all pixels
// around: one pixel's ray has hit by chance a light that all of them reflect.
const TYPICAL: f32 = 2.0;

// The number of traced pixels around a pixel, 25, but not as a constant: if drivers unroll the
// loops, the kernel needs three times the registers.
fn steps_around() -> i32 {
    return i32(min(25u, 25u * settings.scale));
}

// The traced pixel of step `i` around a pixel.
fn place_of(centre: vec2u, i: i32) -> vec2i {
    return clamp(vec2i(centre) + vec2i(i % 5, i / 5) - 2, vec2i(0), vec2i(traced_size()) - 1);
}

// A traced pixel's fit to a surface and the overlap of both lobes, which is larger if the surface
// is rougher.
fn weight_of(place: vec2i, step: vec2i, surface: Surface, material: Specular) -> f32 {
    let guide = textureLoad(guides, place, 0);
    if !is_surface(guide) {
        return 0.0;
    }
    let its = load_specular(traced_pixel(vec2u(place)));
    let alpha = max(material.roughness * material.roughness, 1e-3);
    let normal = guide_normal(guide);
    let bend = 1.0 - dot(normal, surface.shading_normal);
    let unlike = dot(abs(its.reflectance - material.reflectance), vec3f(1.0))
        + abs(its.roughness - material.roughness);
    let spread = f32(dot(step, step)) / (16.0 * alpha + 0.1);
    return fit(guide_position(guide) - surface.position_in_world, normal, surface)
        * exp(-4.0 * bend / (alpha * alpha) - 10.0 * unlike - spread);
}

// The part of a reflection that is above a limit.
fn above(light: vec3f, limit: f32) -> vec3f {
    return light * max(1.0 - limit / max(brightness(light), 1e-20), 0.0);
}

fn filtered(own: vec4f, centre: vec2u, surface: Surface, material: Specular) -> Reflections {
    var sum = vec3f(0.0);
    var roots = 0.0;
    var all = 0.0;
    let steps = steps_around();
    for (var i = 0; i < steps; i++) {
        let place = place_of(centre, i);
        let light = textureLoad(specular_in, place, 0).rgb;
        // NaN must not spread to the pixels around.
        if is_finite(light) {
            let weight = weight_of(place, vec2i(i % 5, i / 5) - 2, surface, material);
            sum += weight * light;
            roots += weight * sqrt(max(brightness(light), 0.0));
            all += weight;
        }
    }
    if all < 1e-3 {
        return Reflections(own.rgb, own.rgb, own.a);
    }
    let root = roots / all;
    let limit = TYPICAL * root * root;
    var excess = vec3f(0.0);
    for (var i = 0; i < steps; i++) {
        let place = place_of(centre, i);
        let light = textureLoad(specular_in, place, 0).rgb;
        if is_finite(light) && brightness(light) > limit {
            let weight = weight_of(place, vec2i(i % 5, i / 5) - 2, surface, material);
            excess += weight * above(light, limit);
        }
    }
    return Reflections(own.rgb - above(own.rgb, limit) + excess / all, sum / all, own.a);
}

@compute @workgroup_size(TILE, TILE)
fn main(
    @builtin(local_invocation_id) local: vec3u,
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = workgroup.y * workgroups.x + workgroup.x;
    if index >= glossy_tiles[0] {
        return;
    }
    let place = place_in_tile(glossy_tiles[1u + index], local.xy);
    if any(place >= traced_size()) {
        return;
    }
    let pixel = traced_pixel(place);
    let surface = load_surface(pixel);
    let material = load_specular(pixel);
    let own = textureLoad(specular_in, place, 0);
    var reflections = Reflections(own.rgb, own.rgb, own.a);
    if reflects(surface, material) {
        reflections = filtered(own, place, surface, material);
    }
    textureStore(reflections_out, place, pack_reflections(reflections));
}
