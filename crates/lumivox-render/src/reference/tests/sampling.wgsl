// Draws directions from surfaces, and writes the results of `scatter`.

import package::render::reference::random::start_random;
import package::render::reference::scatter::{draw_direction, scatter, Surface};
import package::trace::coat::Coat;

struct Case {
    toward: vec3f,
    alpha: f32,
    geometric: vec3f,
    coat_alpha: f32,
    diffuse: f32,
    f0: f32,
    phong_exponent: f32,
    coat_strength: f32,
}

struct Drawn {
    direction: vec3f,
    density: f32,
    value: vec3f,
    padding: f32,
}

@group(0) @binding(0) var<storage, read> cases: array<Case>;
@group(0) @binding(1) var<storage, read_write> drawn: array<Drawn>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let one = cases[invocation.y];
    let surface = Surface(
        vec3f(0.0),
        one.geometric,
        vec3f(0.0, 0.0, 1.0),
        one.toward,
        vec3f(one.diffuse),
        vec3f(one.f0),
        one.alpha,
        one.phong_exponent,
        Coat(one.coat_strength, one.coat_alpha),
    );
    start_random(7u, invocation.x, invocation.y);
    let direction = draw_direction(surface);
    let scattered = scatter(surface, direction);
    let per_case = arrayLength(&drawn) / arrayLength(&cases);
    drawn[invocation.y * per_case + invocation.x] =
        Drawn(direction, scattered.density, scattered.value, 0.0);
}
