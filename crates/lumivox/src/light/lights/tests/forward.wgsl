// An engine's own shadow map: one texture, 0 near and 1 far, a parallel light, no bias.

import package::light::lights::Light;

@group(2) @binding(8) var<storage, read> clip_from_world: mat4x4f;
@group(2) @binding(9) var map: texture_depth_2d;
@group(2) @binding(10) var map_sampler: sampler_comparison;

fn shadow_map_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
    let clip = clip_from_world * vec4f(position_in_world, 1.0);
    let uv = vec2f(0.5 + 0.5 * clip.x, 0.5 - 0.5 * clip.y);
    let texel = 1.0 / vec2f(textureDimensions(map));
    var visible = 0.0;
    for (var tap = 0; tap < 4; tap++) {
        let shift = vec2f(f32(tap & 1) - 0.5, f32(tap >> 1) - 0.5) * texel;
        visible += textureSampleCompareLevel(map, map_sampler, uv + shift, 1.0 - clip.z);
    }
    return 0.25 * visible;
}
