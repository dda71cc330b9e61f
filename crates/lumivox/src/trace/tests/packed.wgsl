// An engine's own G-buffer: one texture of integers, two half floats a word, and reversed depth.

import package::trace::surface::{octahedral_decode, Specular, Surface};
import package::trace::view::{camera_motion, position_from_depth};

@group(3) @binding(1) var packed: texture_2d<u32>;
@group(3) @binding(2) var depth_texture: texture_depth_2d;

fn load_surface(pixel: vec2u) -> Surface {
    let depth = textureLoad(depth_texture, pixel, 0);
    let words = textureLoad(packed, pixel, 0);
    return Surface(
        position_from_depth(pixel, max(depth, 1e-7)),
        depth,
        octahedral_decode(unpack2x16float(words.x)),
        octahedral_decode(unpack2x16float(words.y)),
    );
}

fn load_specular(pixel: vec2u) -> Specular {
    let words = textureLoad(packed, pixel, 0);
    let specular = unpack2x16float(words.z);
    let coat = unpack2x16float(words.w);
    return Specular(vec3f(specular.x), specular.y, 1.0 - coat.x, coat.y);
}

// All surfaces have the same albedo.
fn load_albedo(pixel: vec2u) -> vec4f {
    return vec4f(vec3f(0.5), 1.0);
}

fn load_motion(pixel: vec2u, position_in_world: vec3f) -> vec2f {
    return camera_motion(pixel, position_in_world);
}
