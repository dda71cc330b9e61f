// Draws directions from the panorama, and writes their light and density.

import package::render::reference::panorama::{draw_surroundings, surroundings};
import package::render::reference::random::start_random;
import package::render::reference::world::world;

struct Drawn {
    direction: vec3f,
    density: f32,
    radiance: vec3f,
    padding: f32,
}

@group(0) @binding(7) var<storage, read_write> drawn: array<Drawn>;

@compute @workgroup_size(64)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    if invocation.x >= arrayLength(&drawn) {
        return;
    }
    start_random(world.seed, invocation.x, 0u);
    let direction = draw_surroundings();
    let seen = surroundings(direction);
    drawn[invocation.x] = Drawn(direction, seen.density, seen.soft + seen.peaks, 0.0);
}
