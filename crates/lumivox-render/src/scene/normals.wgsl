// Normals of surfaces: bent by textures, and turned towards the viewer.

// The least cosine between a mirrored direction and the surface's normal: cones at a grazing angle
// would hit their own plane.
const MIRROR_ABOVE: f32 = 0.02;

// Bends a unit normal by the value of a normal texture (0 to 1 a channel).
fn bend(normal: vec3f, tangent_and_sign: vec4f, sampled: vec3f, scale: f32) -> vec3f {
    let local = (2.0 * sampled - 1.0) * vec3f(scale, scale, 1.0);
    // glTF 2.0, section 3.7.2.1; the interpolated tangent is orthogonalized to the normal.
    let tangent = normalize(tangent_and_sign.xyz - normal * dot(normal, tangent_and_sign.xyz));
    let bitangent = tangent_and_sign.w * cross(normal, tangent);
    return normalize(local.x * tangent + local.y * bitangent + local.z * normal);
}

// Turns the normal towards the viewer's side, and so that its mirrored direction is above the
// surface. A smooth or mapped normal may point away from the eye although the surface does not, or
// mirror the eye into the surface: no light comes from there, and a coat or a metal would be black
// at its rim, as jagged as its normal map. So the mirrored direction is lifted to the plane of the
// surface, and the normal becomes the one that mirrors the eye there (Keller et al. 2017, "The Iray
// light transport simulation and rendering system", section A.3).
fn facing(normal: vec3f, geometric: vec3f, toward: vec3f) -> vec3f {
    let below = min(dot(normal, toward), 0.0);
    let seen = normalize(normal - below * toward);
    let mirrored = reflect(-toward, seen);
    // The surface's own plane mirrors at the cosine at which it is seen.
    let depth = min(MIRROR_ABOVE, dot(toward, geometric)) - dot(mirrored, geometric);
    if depth <= 0.0 {
        return seen;
    }
    let lifted = normalize(mirrored + depth * geometric);
    return normalize(toward + lifted);
}
