// Light from far away that a surface gathers: one word for each of FAR_CELLS cells of the
// hemisphere over it (cones/hemisphere.wgsl) with the mean radiance of surfaces farther away than
// NEAR, and the open share of the cell.

// Pixels find surfaces up to this distance, in voxels, by their own rays.
const NEAR = 6.0;

// Nothing is known of a cell: all its surfaces are near, or nothing was gathered. The exponent of
// stored light is never zero.
const NO_FAR_LIGHT = 0u;

// Radiance has 8 bits a channel and a common exponent, openness 3 bits.
struct FarLight {
    radiance: vec3f,
    openness: f32,
}

// The far light of a surface from one direction: the mean of the direction's cell; zero if none of
// the faces around has any.
struct Known {
    radiance: vec3f,
    openness: f32,
    is_known: bool,
}

const BRIGHTEST_FAR = 65280.0;

fn pack_far_light(light: FarLight) -> u32 {
    let radiance = clamp(light.radiance, vec3f(0.0), vec3f(BRIGHTEST_FAR));
    let most = max(radiance.r, max(radiance.g, max(radiance.b, 1e-5)));
    let exponent = clamp(floor(log2(most)) + 1.0, -14.0, 16.0);
    let parts = vec3u(min(round(radiance * exp2(8.0 - exponent)), vec3f(255.0)));
    let open = u32(round(7.0 * saturate(light.openness)));
    return parts.r | (parts.g << 8u) | (parts.b << 16u) | (open << 24u) | (u32(exponent + 15.0) << 27u);
}

fn unpack_far_light(packed: u32) -> FarLight {
    let parts = vec3f(vec3u(packed, packed >> 8u, packed >> 16u) & vec3u(255u));
    let scale = exp2(f32(packed >> 27u) - 15.0 - 8.0);
    return FarLight(parts * scale, f32((packed >> 24u) & 7u) / 7.0);
}
