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

// A weighted sum of the far light of several faces from one direction.
struct FarSum {
    // Radiance in rgb, openness in a.
    light: vec4f,
    // The sum of the weights of faces with far light.
    weight: f32,
}

fn with_far_light(sum: FarSum, packed: u32, weight: f32) -> FarSum {
    let its = unpack_far_light(packed);
    let counted = select(weight, 0.0, packed == NO_FAR_LIGHT);
    return FarSum(sum.light + counted * vec4f(its.radiance, its.openness), sum.weight + counted);
}

fn mean_of(sum: FarSum) -> Known {
    let mean = select(vec4f(0.0), sum.light / sum.weight, sum.weight > 0.0);
    return Known(mean.rgb, mean.a, sum.weight > 0.0);
}

const BRIGHTEST_FAR = 65280.0;

// Powers of two are made of bits, and numbers are converted by signed integers: the CPUs that run
// software GPUs have instructions for these.
fn power_of_two(exponent: i32) -> f32 {
    return bitcast<f32>((exponent + 127) << 23u);
}

fn pack_far_light(light: FarLight) -> u32 {
    let radiance = clamp(light.radiance, vec3f(0.0), vec3f(BRIGHTEST_FAR));
    let most = max(radiance.r, max(radiance.g, radiance.b));
    // The exponent of a power of two above `most`.
    let exponent = clamp(i32(bitcast<u32>(most) >> 23u) - 126, -14, 16);
    let parts = vec3i(min(round(radiance * power_of_two(8 - exponent)), vec3f(255.0)));
    let open = i32(round(7.0 * saturate(light.openness)));
    return u32(parts.r | (parts.g << 8u) | (parts.b << 16u) | (open << 24u) | ((exponent + 15) << 27u));
}

fn unpack_far_light(packed: u32) -> FarLight {
    let parts = vec3i(vec3u(packed, packed >> 8u, packed >> 16u) & vec3u(255u));
    // The exponent has a bias of 15; parts have 8 bits.
    let scale = power_of_two(i32(packed >> 27u) - 23);
    let open = i32((packed >> 24u) & 7u);
    return FarLight(vec3f(parts) * scale, f32(open) * (1.0 / 7.0));
}
