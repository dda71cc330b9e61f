// The G-buffer of three.js, as Lumivox's cones read it, in place of `package::trace::gbuffer`.
//
// `js/gbuffer.js` writes the three textures. Rust puts IS_REVERSED before this text.

import package::trace::surface::{octahedral_decode, Specular, Surface};
import package::trace::view::{position_from_depth, view};

@group(3) @binding(1) var three_depth: texture_depth_2d;
// Octahedral unit vectors: shading normal in xy, geometric normal in zw.
@group(3) @binding(2) var three_normals: texture_2d<f32>;
// Specular reflectance at normal incidence in rgb, perceptual roughness in a.
@group(3) @binding(3) var three_specular: texture_2d<f32>;
// Motion since the previous frame in xy, in normalized device coordinates; strength and perceptual
// roughness of a clear coat in zw.
@group(3) @binding(4) var three_motion: texture_2d<f32>;

fn load_surface(pixel: vec2u) -> Surface {
    let stored = textureLoad(three_depth, pixel, 0);
    let depth = select(1.0 - stored, stored, IS_REVERSED);
    let position = position_from_depth(pixel, max(depth, 1e-7));
    let normals = textureLoad(three_normals, pixel, 0);
    let geometric = octahedral_decode(normals.zw);
    // The geometric normal comes from differences between pixels, which have no side.
    let is_turned = dot(geometric, view.position_in_world - position) < 0.0;
    return Surface(position, depth, octahedral_decode(normals.xy), select(geometric, -geometric, is_turned));
}

fn load_specular(pixel: vec2u) -> Specular {
    let specular = textureLoad(three_specular, pixel, 0);
    let coat = textureLoad(three_motion, pixel, 0).zw;
    return Specular(specular.rgb, specular.a, coat.x, coat.y);
}

fn load_motion(pixel: vec2u, position_in_world: vec3f) -> vec2f {
    return vec2f(0.5, -0.5) * textureLoad(three_motion, pixel, 0).xy;
}
