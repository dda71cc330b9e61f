// Blends one frame's light into the mean of the earlier ones.
//
// Noise and change look alike in a single pixel, but the mean over many pixels cancels only noise.
// So the filtered difference between this frame and the known light (`filter.wgsl`) is compared
// with the noise that remains after the filter. The part of the difference above that noise is
// added to the known light at once, which keeps its detail. This is the positive-part estimator of
// James and Stein (1961): of a difference d with noise s it uses the share 1 - (c s / d)^2, or zero
// below c s.

// The known light of a pixel.
struct Known {
    // Irradiance in rgb, openness in a.
    irradiance: vec4f,
    // Number of frames in the mean; 0 if no light is known.
    frames: f32,
}

// This frame's light at the pixel.
struct Fresh {
    // Mean irradiance of the traced pixels around in rgb, openness in a.
    irradiance: vec4f,
    // Light after the first, the second and the last step of the filter. Far light has no noise,
    // and near light has little, so two steps suffice for the picture.
    first: vec3f,
    second: vec3f,
    wide: vec3f,
    // Mean squared difference of a traced pixel to the known light or, if none is known, to the
    // pixels beside it, divided by their sum.
    noise: f32,
    // 1; 0 if none of the traced pixels shows the surface.
    frames: f32,
    // The filtered difference in rgb; the share of the filter's weight with known light in a.
    change: vec4f,
}

// Number of frames for which doubled light counts, since its new part is less certain.
const FRAMES_OF_CHANGE: f32 = 4.0;
// Differences below this multiple of their noise are noise.
const CERTAIN: f32 = 2.0;
// Number of independent traced pixels in the light after the first and the last step of the filter,
// on a plain surface.
const FIRST_PIXELS: f32 = 7.0;
const WIDE_PIXELS: f32 = 400.0;
// Frame count assigned to the first filtered frame.
const FIRST_FRAMES: f32 = 2.0;
// Above this number of frames, the pixel's own light has more weight than the filtered light.
const FILTERED_FRAMES: f32 = 128.0;

// Frame count of light after a relative change by `share`: variances add up.
fn frames_after_change(frames: f32, share: f32) -> f32 {
    let most = FRAMES_OF_CHANGE / max(share * share, 1e-6);
    return frames * most / (frames + most);
}

// Adds a difference; darkening scales the light instead, so that black stays black and nothing
// becomes negative.
fn shift(light: vec3f, change: vec3f, was: vec3f) -> vec3f {
    let scale = clamp(1.0 + change / max(was, vec3f(1e-6)), vec3f(0.0), vec3f(1.0));
    return select(light + change, light * scale, change < vec3f(0.0));
}

// This frame's light without its noise: after two steps of the filter, plus the first step's detail
// times its share above noise (Wiener filter), as in a penumbra.
fn filtered(fresh: Fresh, frames: f32) -> vec3f {
    let detail = fresh.first - fresh.second;
    let size = dot(abs(detail), vec3f(1.0 / 3.0));
    // The sum over a few cones may be negative.
    let both = dot(abs(fresh.first) + abs(fresh.second), vec3f(1.0 / 3.0));
    let variance = fresh.noise * both / FIRST_PIXELS;
    let certain = max(1.0 - variance / max(size * size, 1e-20), 0.0);
    return fresh.second + max(certain, frames / (1.0 + frames)) * detail;
}

fn blend(known: Known, fresh: Fresh) -> Known {
    if known.frames <= 0.0 {
        return Known(vec4f(filtered(fresh, 0.0), fresh.irradiance.a), FIRST_FRAMES);
    }
    var past = known.irradiance;
    var frames = known.frames;
    if fresh.change.a > 1e-3 {
        let change = fresh.change.rgb / fresh.change.a;
        let size = dot(abs(change), vec3f(1.0 / 3.0));
        let was = fresh.wide - change;
        let both = dot(abs(fresh.wide) + abs(was), vec3f(1.0 / 3.0));
        let variance = fresh.noise * both / (WIDE_PIXELS * fresh.change.a * fresh.change.a);
        let certain = max(1.0 - CERTAIN * CERTAIN * variance / max(size * size, 1e-20), 0.0);
        past = vec4f(shift(past.rgb, certain * change, was), past.a);
        let share = certain * size / max(dot(was, vec3f(1.0 / 3.0)), 1e-6);
        frames = frames_after_change(frames, share);
    }
    let share = FILTERED_FRAMES / (FILTERED_FRAMES + frames);
    let sample = mix(fresh.irradiance.rgb, filtered(fresh, frames), share);
    let weight = fresh.frames / (frames + 1.0);
    return Known(mix(past, vec4f(sample, fresh.irradiance.a), weight), max(frames + fresh.frames, 1.0));
}
