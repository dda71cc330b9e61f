// The camera of a G-buffer, in group 3 of every pass over the screen.

struct CameraView {
    clip_from_world: mat4x4f,
    world_from_clip: mat4x4f,
    // clip_from_world of the previous frame.
    previous_clip_from_world: mat4x4f,
    previous_world_from_clip: mat4x4f,
    position_in_world: vec3f,
    // Number of accumulated frames; it advances the jitter.
    frame: u32,
    size: vec2u,
    // Whether Lumivox's own G-buffer has a motion texture.
    has_motion: u32,
    padding_0: u32,
    // Sub-pixel shift of the picture that both matrices contain, in pixels.
    jitter: vec2f,
    padding_1: vec2u,
}

// A storage buffer, not a uniform: lavapipe 22.3 crashes when it inlines uniforms into kernels that
// march cones from here.
@group(3) @binding(0) var<storage, read> view: CameraView;

// The pixel that a point in the world is projected to; outside of the picture for points behind the
// camera.
fn pixel_of(position_in_world: vec3f) -> vec2i {
    let clip = view.clip_from_world * vec4f(position_in_world, 1.0);
    let ndc = clip.xy / clip.w;
    let place = floor(vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y) * vec2f(view.size));
    return select(vec2i(-1), vec2i(clamp(place, vec2f(-1.0), vec2f(view.size))), clip.w > 0.0);
}

// World position of a pixel's center at a depth in clip space.
fn position_from_depth(pixel: vec2u, depth: f32) -> vec3f {
    return position_at(vec2f(pixel) + 0.5, depth);
}

// World position of a point in the picture, in pixels, at a depth in clip space.
fn position_at(place: vec2f, depth: f32) -> vec3f {
    let uv = place / vec2f(view.size);
    let ndc = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    let world = view.world_from_clip * vec4f(ndc, depth, 1.0);
    return world.xyz / world.w;
}

// The unit vector from the camera through a pixel's center, computed from its point at infinity:
// for nearby points, subtracting the camera's position would lose precision.
fn ray_direction(pixel: vec2u) -> vec3f {
    let uv = (vec2f(pixel) + 0.5) / vec2f(view.size);
    let ndc = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    let far = view.world_from_clip * vec4f(ndc, 0.0, 1.0);
    return normalize(far.xyz - far.w * view.position_in_world);
}

// The motion of a static point in the picture since the previous frame, caused only by the camera:
// as a share of the picture, x to the right, y down.
fn camera_motion(pixel: vec2u, position_in_world: vec3f) -> vec2f {
    let clip = view.previous_clip_from_world * vec4f(position_in_world, 1.0);
    let ndc = clip.xy / clip.w;
    let previous = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
    return (vec2f(pixel) + 0.5) / vec2f(view.size) - previous;
}
