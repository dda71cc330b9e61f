// Bevy's deferred G-buffer, read in place of Lumivox's own.

import package::trace::surface::{octahedral_decode, Specular, Surface};
import package::trace::view::{position_from_depth, view};

struct Place {
    // The viewport's corner in the textures.
    origin: vec2u,
    padding: vec2u,
}

// sRGB colour (gamma 2.2) and roughness, emission, properties, normal and flags.
@group(3) @binding(1) var deferred: texture_2d<u32>;
@group(3) @binding(2) var depth_texture: texture_depth_2d;
@group(3) @binding(3) var motion_texture: texture_2d<f32>;
@group(3) @binding(4) var<uniform> place: Place;

const UNLIT: u32 = 1u;

struct Properties {
    reflectance: f32,
    metallic: f32,
    occlusion: f32,
    coat: f32,
    coat_roughness: f32,
}

fn load_words(pixel: vec2u) -> vec4u {
    return textureLoad(deferred, pixel + place.origin, 0);
}

fn decode_properties(word: u32) -> Properties {
    let shares = unpack4x8unorm(word);
    let coat = word >> 24u;
    return Properties(shares.x, shares.y, shares.z, f32(coat & 15u) / 15.0, f32(coat >> 4u) / 30.0);
}

// Bevy uses Lumivox's octahedral encoding, mapped to 0 to 1, in 12 bits each.
fn decode_normal(word: u32) -> vec3f {
    let encoded = vec2f(vec2u(word, word >> 12u) & vec2u(4095u)) / 4095.0;
    return octahedral_decode(2.0 * encoded - 1.0);
}

// False for unlit surfaces, and for forward draws, whose words are zeros.
fn is_lit(words: vec4u) -> bool {
    return any(words != vec4u(0u)) && ((words.w >> 24u) & UNLIT) == 0u;
}

fn load_depth(pixel: vec2u) -> f32 {
    return textureLoad(depth_texture, pixel + place.origin, 0);
}

// The step from a pixel to its neighbour before or behind it along an axis of the picture,
// whichever is closer in depth.
fn step_along(pixel: vec2u, axis: u32, depth: f32, position: vec3f) -> vec3f {
    var one = vec2u(0u);
    one[axis] = 1u;
    let before = max(pixel, one) - one;
    let behind = min(pixel + one, view.size - 1u);
    let depth_before = load_depth(before);
    let depth_behind = load_depth(behind);
    let takes_before = before[axis] < pixel[axis]
        && (behind[axis] == pixel[axis] || abs(depth_before - depth) < abs(depth_behind - depth));
    if takes_before {
        return position - position_from_depth(before, max(depth_before, 1e-7));
    }
    return position_from_depth(behind, max(depth_behind, 1e-7)) - position;
}

// Least cosine between the shading normal and the normal from depths; below it is an edge.
const LEAST_AGREEMENT: f32 = 0.3;

// The surface normal without normal map, from the depths around the pixel, towards the camera.
fn geometric_normal(pixel: vec2u, depth: f32, position: vec3f, shading: vec3f) -> vec3f {
    let to_camera = view.position_in_world - position;
    let across = cross(
        step_along(pixel, 0u, depth, position), step_along(pixel, 1u, depth, position));
    let size = length(across);
    let normal = across / max(size, 1e-30) * select(1.0, -1.0, dot(across, to_camera) < 0.0);
    // Flips the normal on the backs of double-sided surfaces.
    let own = select(shading, -shading, dot(shading, to_camera) < 0.0);
    return select(own, normal, size > 0.0 && dot(normal, own) > LEAST_AGREEMENT);
}

fn load_surface(pixel: vec2u) -> Surface {
    let words = load_words(pixel);
    let depth = load_depth(pixel);
    let position = position_from_depth(pixel, max(depth, 1e-7));
    var shading = decode_normal(words.w);
    let geometric = geometric_normal(pixel, depth, position, shading);
    shading = select(shading, -shading, dot(shading, geometric) < 0.0);
    return Surface(position, select(0.0, depth, is_lit(words)), shading, geometric);
}

// Base colour in rgb, roughness in a.
fn load_base(words: vec4u) -> vec4f {
    let base = unpack4x8unorm(words.x);
    return vec4f(pow(base.rgb, vec3f(2.2)), base.a);
}

fn load_specular(pixel: vec2u) -> Specular {
    let words = load_words(pixel);
    let base = load_base(words);
    let properties = decode_properties(words.z);
    let dielectric = 0.16 * properties.reflectance * properties.reflectance;
    let reflectance = mix(vec3f(dielectric), base.rgb, properties.metallic);
    return Specular(reflectance, base.a, properties.coat, properties.coat_roughness);
}

// Diffuse albedo in rgb, the material's own occlusion in a.
fn load_albedo(pixel: vec2u) -> vec4f {
    let words = load_words(pixel);
    let properties = decode_properties(words.z);
    return vec4f(load_base(words).rgb * (1.0 - properties.metallic), properties.occlusion);
}

fn load_motion(pixel: vec2u, position_in_world: vec3f) -> vec2f {
    return textureLoad(motion_texture, pixel + place.origin, 0).xy;
}
