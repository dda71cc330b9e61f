// The last frame's light at a texel, and the texel's fit to a surface.

import package::temporal::record::decode_record;
import package::trace::fit::fit;
import package::trace::surface::Surface;
import package::trace::view::view;

// Irradiance in rgb, openness in a.
@group(1) @binding(1) var past_irradiance: texture_2d<f32>;
@group(1) @binding(2) var past_specular: texture_2d<f32>;
@group(1) @binding(3) var past_records: texture_2d<u32>;

// A texel or a neighbour with a larger fit shows the same surface.
const SAME_SURFACE: f32 = 0.5;

// The size of the recalled picture, which may differ from this frame's.
fn past_size() -> vec2f {
    return vec2f(textureDimensions(past_records));
}

// The position of a texel's surface when it was recorded. It is at the texel's center, even if
// another point of the texel was sampled.
fn past_position(texel: vec2i, depth: f32) -> vec3f {
    let uv = (vec2f(texel) + 0.5) / past_size() + view.jitter / vec2f(view.size);
    let ndc = vec2f(2.0 * uv.x - 1.0, 1.0 - 2.0 * uv.y);
    let world = view.previous_world_from_clip * vec4f(ndc, depth, 1.0);
    return world.xyz / world.w;
}

// The fit of a texel to the surface, 0 to 1.
fn texel_fit(texel: vec2i, surface: Surface, slack: f32) -> f32 {
    if any(texel < vec2i(0)) || any(texel >= vec2i(past_size())) {
        return 0.0;
    }
    let record = decode_record(textureLoad(past_records, texel, 0).xy);
    if record.frames <= 0.0 {
        return 0.0;
    }
    let offset = past_position(texel, record.depth) - surface.position_in_world;
    return fit(offset / slack, record.normal, surface);
}

// The place in the last frame where a motion starts, in texels; whole numbers are centers of
// texels.
fn former_place(pixel: vec2u, motion: vec2f) -> vec2f {
    let ratio = past_size() / vec2f(view.size);
    return ratio * vec2f(pixel) + 0.5 * (ratio - 1.0) - motion * past_size();
}
