// Screen-space motion of objects that have moved since the last frame: the surface's position minus
// its former position, in shares of the picture, x to the right, y down. It is tested against the
// G-buffer's depths.

import package::render::scene::draws::draws;

struct MotionView {
    clip_from_world: mat4x4f,
    previous_clip_from_world: mat4x4f,
}

@group(0) @binding(0) var<uniform> motion_view: MotionView;
// The former transform of each draw that has moved.
@group(0) @binding(2) var<storage, read> former_draws: array<mat4x4f>;

struct Moved {
    // Invariant, as in the G-buffer's pipelines, since depths are compared.
    @builtin(position) @invariant clip: vec4f,
    @location(0) now: vec4f,
    @location(1) before: vec4f,
}

@vertex
fn vertex(
    @location(0) position: vec3f,
    @location(1) former_position: vec3f,
    @builtin(instance_index) draw: u32,
) -> Moved {
    let world = draws[draw].world_from_local * vec4f(position, 1.0);
    let clip = motion_view.clip_from_world * world;
    let former_world = former_draws[draw] * vec4f(former_position, 1.0);
    return Moved(clip, clip, motion_view.previous_clip_from_world * former_world);
}

@fragment
fn fragment(moved: Moved) -> @location(0) vec4f {
    let motion = moved.now.xy / moved.now.w - moved.before.xy / moved.before.w;
    return vec4f(0.5 * motion.x, -0.5 * motion.y, 0.0, 0.0);
}
