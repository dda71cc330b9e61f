// Far light of a surface: one word for each of FAR_CELLS cells of its hemisphere
// (cones/hemisphere.wgsl), with the mean radiance of surfaces farther away than NEAR, and the open
// share of the cell.

// Pixels' own rays find surfaces up to this distance, in voxels.
const NEAR = 6.0;

// The word of a cell without far light: all its surfaces are near, or nothing was gathered. Other
// words are never zero, since their exponent is not.
const NO_FAR_LIGHT = 0u;

// Stored with 8 bits per channel of radiance, a common exponent, and 3 bits of openness.
struct FarLight {
    radiance: vec3f,
    openness: f32,
}

// The far light of a surface from one direction: the mean of the direction's cell over the faces
// around; zero if none of them has far light.
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
    // Two to the power of the exponent minus 23 (bias 15, 8 bits).
    let scale = bitcast<f32>(((packed >> 27u) + (127u - 23u)) << 23u);
    return FarLight(parts * scale, f32((packed >> 24u) & 7u) / 7.0);
}
