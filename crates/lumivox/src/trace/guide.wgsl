// The surface of a traced pixel in one texel, for filters: the position in the world, and the
// shading normal (octahedral, 16 bits a coordinate).

import package::trace::surface::{octahedral_decode, octahedral_encode, Surface};

// The texel of a pixel without surface.
const NO_SURFACE: vec4u = vec4u(0xffffffffu);

fn guide_of(surface: Surface) -> vec4u {
    let normal = pack2x16snorm(octahedral_encode(surface.shading_normal));
    return select(NO_SURFACE, vec4u(bitcast<vec3u>(surface.position_in_world), normal), surface.depth > 0.0);
}

fn is_surface(guide: vec4u) -> bool {
    return any(guide != NO_SURFACE);
}

fn guide_position(guide: vec4u) -> vec3f {
    return bitcast<vec3f>(guide.xyz);
}

fn guide_normal(guide: vec4u) -> vec3f {
    return octahedral_decode(unpack2x16snorm(guide.w));
}
