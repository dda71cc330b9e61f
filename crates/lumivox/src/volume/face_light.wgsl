// The light that arrives at a face, for mirrors: in the texel after its far light (far_light.wgsl).

import package::constants::LARGEST_HALF;
import package::volume::far_light::{pack_far_light, unpack_far_light, FarLight};

struct FaceLight {
    // The gathered irradiance, averaged over adjacent faces.
    gathered: vec3f,
    // The irradiance of the lights.
    direct: vec3f,
    // The share of irradiance that the face reflects.
    reflected: vec3f,
    // 1; 0 for a hidden face, and for one that has not gathered yet.
    weight: f32,
}

fn pack_face_light(light: FaceLight) -> vec4u {
    let gathered = min(light.gathered, vec3f(LARGEST_HALF));
    return vec4u(
        pack2x16float(gathered.rg),
        pack2x16float(vec2f(gathered.b, light.reflected.r)),
        pack2x16float(light.reflected.gb),
        pack_far_light(FarLight(light.direct, light.weight)),
    );
}

fn unpack_face_light(words: vec4u) -> FaceLight {
    let between = unpack2x16float(words.y);
    let direct = unpack_far_light(words.w);
    return FaceLight(
        vec3f(unpack2x16float(words.x), between.x),
        direct.radiance,
        vec3f(between.y, unpack2x16float(words.z)),
        direct.openness,
    );
}
