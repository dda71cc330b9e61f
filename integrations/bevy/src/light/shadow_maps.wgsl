// Bevy's shadow maps, read in place of Lumivox's own. Depth is reversed.

import package::constants::LIGHT_POINT;
import package::light::lights::{is_parallel, Light};

struct ShadowLayer {
    clip_from_world: mat4x4f,
    // Layer in the texture.
    layer: u32,
    // Edge of a texel: per metre of distance, or in metres for suns.
    texel_size: f32,
    // In a sun's first layer: the number of its cascades.
    cascades: u32,
    padding: u32,
}

@group(2) @binding(8) var<storage, read> shadow_layers: array<ShadowLayer>;
// Six layers per point light.
@group(2) @binding(9) var cube_maps: texture_depth_2d_array;
// Cascades of suns, followed by spot lights.
@group(2) @binding(10) var flat_maps: texture_depth_2d_array;
@group(2) @binding(11) var shadow_sampler: sampler_comparison;

// The face that a direction points at, in Bevy's order: +x, -x, +y, -y, -z, +z.
fn face_of(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z {
        return select(0u, 1u, direction.x < 0.0);
    }
    if size.y >= size.z {
        return select(2u, 3u, direction.y < 0.0);
    }
    return select(5u, 4u, direction.z < 0.0);
}

fn compare(is_cube: bool, uv: vec2f, layer: u32, depth: f32) -> f32 {
    if is_cube {
        return textureSampleCompareLevel(cube_maps, shadow_sampler, uv, layer, depth);
    }
    return textureSampleCompareLevel(flat_maps, shadow_sampler, uv, layer, depth);
}

// The share of light that reaches a position in a layer.
fn filtered(is_cube: bool, uv: vec2f, layer: u32, depth: f32) -> f32 {
    let size = select(textureDimensions(flat_maps), textureDimensions(cube_maps), is_cube);
    var visible = 0.0;
    for (var tap = 0; tap < 4; tap++) {
        let shift = (vec2f(f32(tap & 1), f32(tap >> 1)) - 0.5) / vec2f(size);
        visible += compare(is_cube, uv + shift, layer, depth);
    }
    return 0.25 * visible;
}

fn uv_of(ndc: vec2f) -> vec2f {
    return vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
}

// Visibility in a sun's first cascade that covers the position; negative if none does.
fn sun_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
    let first = light.shadow_layer;
    let border = 2.0 / vec2f(textureDimensions(flat_maps));
    for (var index = first; index < first + shadow_layers[first].cascades; index++) {
        let layer = shadow_layers[index];
        let receiver = position_in_world + normal * (2.0 * layer.texel_size);
        let ndc = (layer.clip_from_world * vec4f(receiver, 1.0)).xyz;
        let uv = uv_of(ndc.xy);
        // Casters in front of the near plane are drawn at its depth, so they shade everything
        // behind it. Receivers in front of it are not in this layer.
        let is_inside = all(uv > border) && all(uv < 1.0 - border) && ndc.z > 0.0 && ndc.z < 1.0;
        if is_inside {
            return filtered(false, uv, layer.layer, ndc.z);
        }
    }
    return -1.0;
}

fn shadow_map_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
    if is_parallel(light) {
        return sun_visibility(light, position_in_world, normal);
    }
    let is_cube = light.kind == LIGHT_POINT;
    var index = light.shadow_layer;
    if is_cube {
        index += face_of(position_in_world - light.position_in_world);
    }
    let layer = shadow_layers[index];
    // With this offset, a plane never shades itself within the filter's reach of two texels.
    let reach = 2.0 * layer.texel_size * distance(position_in_world, light.position_in_world);
    let clip = layer.clip_from_world * vec4f(position_in_world + normal * reach, 1.0);
    if clip.w <= 0.0 {
        return 1.0;
    }
    let ndc = clip.xyz / clip.w;
    let uv = uv_of(ndc.xy);
    if any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) {
        return 1.0;
    }
    return filtered(is_cube, uv, layer.layer, ndc.z);
}
