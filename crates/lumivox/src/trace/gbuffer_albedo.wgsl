// The diffuse albedo of a pixel, from Lumivox's own G-buffer: the module
// package::trace::albedo_method.

import package::trace::gbuffer::gbuffer_diffuse;

const KNOWS_ALBEDO = true;

fn load_albedo(pixel: vec2u) -> vec3f {
    return textureLoad(gbuffer_diffuse, pixel, 0).rgb;
}
