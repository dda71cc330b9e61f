// Visibility from shadow maps: layers of one depth array, reversed z (1 near, 0 far), greater is
// nearer.
//
// A caller's own module (`GiConfig::shadow_maps`) replaces it as `package::light::shadow_map`, with
// its own bindings from 8 on and the function shadow_map_visibility.

import package::constants::LIGHT_POINT;
import package::light::lights::Light;

struct ShadowLayer {
    clip_from_world: mat4x4f,
    // Edge of a texel in the world: per metre of distance for a perspective layer, in metres for a
    // parallel one.
    texel_size: f32,
    is_perspective: u32,
    // Whether the next layer lies within this one and has smaller texels.
    has_finer: u32,
    padding: u32,
}

@group(2) @binding(2) var<storage, read> shadow_layers: array<ShadowLayer>;
@group(2) @binding(3) var shadow_maps: texture_depth_2d_array;
@group(2) @binding(4) var shadow_sampler: sampler_comparison;

// The face of a cube map that a direction points at: +x -x +y -y +z -z.
fn cube_face(direction: vec3f) -> u32 {
    let size = abs(direction);
    if size.x >= size.y && size.x >= size.z {
        return select(0u, 1u, direction.x < 0.0);
    }
    if size.y >= size.z {
        return select(2u, 3u, direction.y < 0.0);
    }
    return select(4u, 5u, direction.z < 0.0);
}

// The share of the light that reaches a surface point, 0 to 1, filtered over 2x2 bilinear
// comparisons.
fn shadow_map_visibility(light: Light, position_in_world: vec3f, normal: vec3f) -> f32 {
    var layer_index = light.shadow_layer;
    if light.kind == LIGHT_POINT {
        layer_index += cube_face(position_in_world - light.position_in_world);
    }
    layer_index = finest_layer(layer_index, position_in_world, normal);
    let layer = shadow_layers[layer_index];
    var texel_m = layer.texel_size;
    if layer.is_perspective != 0u {
        texel_m *= distance(position_in_world, light.position_in_world);
    }
    let place = place_in_layer(layer.clip_from_world, texel_m, position_in_world, normal);
    if any(place.xy < vec2f(0.0)) || any(place.xy > vec2f(1.0)) {
        return 1.0;
    }
    return compare_depths(shadow_maps, shadow_sampler, layer_index, place);
}

// The last of the nested layers, starting with `first`, that contains a surface point.
fn finest_layer(first: u32, position_in_world: vec3f, normal: vec3f) -> u32 {
    var index = first;
    while shadow_layers[index].has_finer != 0u {
        let finer = shadow_layers[index + 1u];
        let place = place_in_layer(finer.clip_from_world, finer.texel_size, position_in_world, normal);
        if !is_within(place, shadow_maps) {
            break;
        }
        index += 1u;
    }
    return index;
}

// A surface point in a layer: texture coordinates in xy, negative behind the light, and depth in z.
fn place_in_layer(
    clip_from_world: mat4x4f,
    texel_m: f32,
    position_in_world: vec3f,
    normal: vec3f,
) -> vec3f {
    // Within the filter's reach of 2 texels a plane tilted against the light changes its depth by
    // at most 2 texels times the tangent of the tilt. Moving the receiver along its normal by 2
    // texels undoes that at any tilt: the move is 2 cosines towards the light and 2 sines across.
    let receiver = position_in_world + normal * (2.0 * texel_m);
    let clip = clip_from_world * vec4f(receiver, 1.0);
    if clip.w <= 0.0 {
        return vec3f(-1.0);
    }
    let ndc = clip.xyz / clip.w;
    // A ground that extends far behind the scene lies behind the map's far plane: it is tested at
    // the far plane, where the map still holds its occluders.
    return vec3f(0.5 + 0.5 * ndc.x, 0.5 - 0.5 * ndc.y, max(ndc.z, 0.0));
}

// Whether the filter stays within a layer.
fn is_within(place: vec3f, maps: texture_depth_2d_array) -> bool {
    let margin = 2.0 / vec2f(textureDimensions(maps));
    return all(place.xy >= margin) && all(place.xy <= 1.0 - margin);
}

fn compare_depths(
    maps: texture_depth_2d_array,
    compare: sampler_comparison,
    layer_index: u32,
    place: vec3f,
) -> f32 {
    let texel = 1.0 / vec2f(textureDimensions(maps));
    var visible = 0.0;
    for (var tap = 0; tap < 4; tap++) {
        let shift = vec2f(f32(tap & 1) - 0.5, f32(tap >> 1) - 0.5) * texel;
        visible += textureSampleCompareLevel(maps, compare, place.xy + shift, layer_index, place.z);
    }
    return 0.25 * visible;
}
