// Diffuse cones from the pixels of the G-buffer: irradiance in rgb, openness in a.

import package::cascades::drawn_level;
import package::constants::LARGEST_HALF;
import package::gpu::random::{hash, random_pair};
import package::emitters::gather::gather_emitters;
import package::trace::gbuffer::load_surface;
import package::trace::gather_method::gather_surface;
import package::trace::guide::guide_of;
import package::trace::screen::{settings, traced_pixel, traced_size, traced_turn, TURNS_APART};

@group(1) @binding(1) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(2) var samples_out: texture_storage_2d<r32float, write>;
@group(1) @binding(3) var guides_out: texture_storage_2d<rgba32uint, write>;

struct TracedDiffuse {
    irradiance: vec4f,
    samples: f32,
}

// The light that a surface gathers at a pixel; `turn` is the index in the jitter sequence.
fn gather_at(
    position_in_world: vec3f,
    shading_normal: vec3f,
    geometric_normal: vec3f,
    pixel: vec2u,
    turn: u32,
) -> TracedDiffuse {
    let start = random_pair(pixel.x, hash(pixel.y));
    let level = drawn_level(position_in_world, fract(start.x + 0.618034 * f32(turn & 0xffffu)));
    let gathered = gather_surface(
        position_in_world,
        shading_normal,
        geometric_normal,
        level,
        settings.diffuse_cones,
        start,
        turn,
        settings.cones,
    );
    let lit = gather_emitters(
        position_in_world,
        shading_normal,
        geometric_normal,
        level,
        random_pair(pixel.x ^ 0x9e3779b9u, hash(pixel.y)),
        turn,
        settings.emitter_rays,
        settings.cones,
    );
    return TracedDiffuse(
        vec4f(gathered.irradiance + lit.irradiance, gathered.openness),
        f32(gathered.samples + lit.samples),
    );
}

// The mean of `turns` turns, starting at `turn`; samples are added.
fn trace_diffuse(pixel: vec2u, turn: u32, turns: u32) -> TracedDiffuse {
    let surface = load_surface(pixel);
    if surface.depth <= 0.0 || settings.bounces == 0u {
        return TracedDiffuse(vec4f(0.0, 0.0, 0.0, 1.0), 0.0);
    }
    var mean = TracedDiffuse(vec4f(0.0), 0.0);
    for (var i = 0u; i < turns; i++) {
        let traced = gather_at(
            surface.position_in_world,
            surface.shading_normal,
            surface.geometric_normal,
            pixel,
            turn + i * TURNS_APART,
        );
        mean.irradiance += traced.irradiance / f32(turns);
        mean.samples += traced.samples;
    }
    // Next to a filament the irradiance may exceed the largest half float.
    mean.irradiance = min(mean.irradiance, vec4f(LARGEST_HALF));
    return mean;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    if any(invocation.xy >= traced_size()) {
        return;
    }
    let pixel = traced_pixel(invocation.xy);
    textureStore(guides_out, invocation.xy, guide_of(load_surface(pixel)));
    let traced = trace_diffuse(pixel, traced_turn(), settings.turns);
    textureStore(irradiance_out, invocation.xy, traced.irradiance);
    textureStore(samples_out, invocation.xy, vec4f(traced.samples, 0.0, 0.0, 0.0));
}
