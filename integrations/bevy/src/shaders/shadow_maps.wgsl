// Bevy's shadow maps of point and spot lights, read in place of Lumivox's own. Depth is reversed.

import package::constants::LIGHT_POINT;
import package::light::lights::Light;

struct ShadowLayer {
    clip_from_world: mat4x4f,
    // The layer of its texture.
    layer: u32,
    // Edge of a texel, per metre of distance.
    texel_size: f32,
    padding: vec2u,
}

@group(2) @binding(8) var<storage, read> shadow_layers: array<ShadowLayer>;
// Six layers a point light.
@group(2) @binding(9) var cube_maps: texture_depth_2d_array;
// Cascades of suns, and behind them spot lights.
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

fn shadow_map_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
    let is_cube = light.kind == LIGHT_POINT;
    var index = light.shadow_layer;
    if is_cube {
        index += face_of(position_in_world - light.position_in_world);
    }
    let layer = shadow_layers[index];
    // A plane within the filter's reach of two texels then never shades itself.
    let reach = 2.0 * layer.texel_size * distance(position_in_world, light.position_in_world);
    let clip = layer.clip_from_world * vec4f(position_in_world + normal * reach, 1.0);
    if clip.w <= 0.0 {
        return 1.0;
    }
    let ndc = clip.xyz / clip.w;
    let uv = vec2f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y);
    if any(uv < vec2f(0.0)) || any(uv > vec2f(1.0)) {
        return 1.0;
    }
    let size = select(textureDimensions(flat_maps), textureDimensions(cube_maps), is_cube);
    var visible = 0.0;
    for (var tap = 0; tap < 4; tap++) {
        let shift = (vec2f(f32(tap & 1), f32(tap >> 1)) - 0.5) / vec2f(size);
        visible += compare(is_cube, uv + shift, layer.layer, ndc.z);
    }
    return 0.25 * visible;
}
