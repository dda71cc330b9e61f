// Surfaces of traced pixels, packed for the filter: the position in voxels in xyz, the normal in w
// (octahedral, 12 bits a coordinate, as an integer); w is negative without surface.

import package::grid::grid_from_world;
import package::trace::surface::{octahedral_decode, octahedral_encode, Surface};

const NORMAL_STEPS: f32 = 4095.0;

const NO_SURFACE: vec4f = vec4f(0.0, 0.0, 0.0, -1.0);

fn pack_guide(surface: Surface) -> vec4f {
    let place = round((0.5 + 0.5 * octahedral_encode(surface.shading_normal)) * NORMAL_STEPS);
    return vec4f(grid_from_world(surface.position_in_world), place.x + 4096.0 * place.y);
}

fn guide_normal(guide: vec4f) -> vec3f {
    let packed = u32(guide.w);
    let place = vec2f(vec2u(packed & 4095u, packed >> 12u)) / NORMAL_STEPS;
    return octahedral_decode(2.0 * place - 1.0);
}
