// Normals of surfaces: bent by textures, and turned to where they are seen from.

// A unit normal, bent by what a normal texture holds (0 to 1 a channel).
fn bend(normal: vec3f, tangent_and_sign: vec4f, sampled: vec3f, scale: f32) -> vec3f {
    let local = (2.0 * sampled - 1.0) * vec3f(scale, scale, 1.0);
    // glTF 2.0, section 3.7.2.1; the interpolated tangent is made orthogonal to the normal again.
    let tangent = normalize(tangent_and_sign.xyz - normal * dot(normal, tangent_and_sign.xyz));
    let bitangent = tangent_and_sign.w * cross(normal, tangent);
    return normalize(local.x * tangent + local.y * bitangent + local.z * normal);
}

// Towards the side it is seen from. A smooth or mapped normal may point away from there where the surface itself
// does not; nothing is seen from below, so it is lifted to the horizon.
fn facing(normal: vec3f, toward: vec3f) -> vec3f {
    let below = min(dot(normal, toward), 0.0);
    return normalize(normal - below * toward);
}
