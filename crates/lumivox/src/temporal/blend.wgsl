// One frame's light into the mean of those before.
//
// Noise and change look alike in a single pixel, but noise goes away in the mean over many pixels and change does not.
// So the filtered difference between this frame and what is known (`filter.wgsl`) is compared with what noise would leave of it: as far as it
// is more, the known light takes the difference, at once, and keeps its detail. It is the estimator of James and Stein (1961) with a
// positive part: of a difference d whose noise is s it takes 1 - (c s / d)^2, nothing below c s.

// What is known of a pixel.
struct Known {
    // Irradiance in rgb, openness in a.
    irradiance: vec4f,
    // How many frames it is the mean of; 0: nothing is known.
    frames: f32,
}

const FILTER_STEPS: u32 = 4u;
const WIDEST: u32 = FILTER_STEPS - 1u;

// What this frame says about it.
struct Fresh {
    // Of the traced pixels around, openness in a.
    irradiance: vec4f,
    // The same after each step of the filter, from fine to wide.
    steps: array<vec3f, FILTER_STEPS>,
    // The mean squared difference of a traced pixel to the known light, or else to the pixels beside it, over the sum of both.
    noise: f32,
    // 1, or 0 if none of the traced pixels shows the surface.
    frames: f32,
    // The filtered difference in rgb; in a the share of the filter where something is known.
    change: vec4f,
}

// Light that has become twice as bright counts for as many frames: the part that is new is known less well.
const FRAMES_OF_CHANGE: f32 = 4.0;
// Differences below this many times their noise are noise.
const CERTAIN: f32 = 2.0;
// Independent traced pixels in the light after so many steps of the filter, on a plain surface.
const FILTER_PIXELS: vec4f = vec4f(7.0, 34.0, 140.0, 400.0);
// The frames that the first filtered one counts for.
const FIRST_FRAMES: f32 = 2.0;
// With more frames than this, what a pixel gathers itself counts for more than the filtered light.
const FILTERED_FRAMES: f32 = 128.0;

// The frames that light counts for after it has changed by a share of itself: variances add up.
fn frames_after_change(frames: f32, share: f32) -> f32 {
    let most = FRAMES_OF_CHANGE / max(share * share, 1e-6);
    return frames * most / (frames + most);
}

// Adds a difference; darker light scales, so that black stays black and nothing gets below it.
fn shift(light: vec3f, change: vec3f, was: vec3f) -> vec3f {
    let scale = clamp(1.0 + change / max(was, vec3f(1e-6)), vec3f(0.0), vec3f(1.0));
    return select(light + change, light * scale, change < vec3f(0.0));
}

// The steps of the filter that this frame's light goes through: light from afar has no noise, and what is near has little.
const FILTERED: u32 = 1u;

// This frame's light without its noise: the filter's, and from step to step of it what is finer, by the
// share of it that is not noise (Wiener's filter), as in a penumbra.
fn filtered(fresh: Fresh, frames: f32) -> vec3f {
    var light = fresh.steps[FILTERED];
    for (var i = i32(FILTERED) - 1; i >= 0; i--) {
        let detail = fresh.steps[i] - fresh.steps[i + 1];
        let size = dot(abs(detail), vec3f(1.0 / 3.0));
        // A few cones may sum up below zero.
        let both = dot(abs(fresh.steps[i]) + abs(fresh.steps[i + 1]), vec3f(1.0 / 3.0));
        let variance = fresh.noise * both / FILTER_PIXELS[i];
        let certain = max(1.0 - variance / max(size * size, 1e-20), 0.0);
        light += max(certain, frames / (1.0 + frames)) * detail;
    }
    return light;
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
        let wide = fresh.steps[WIDEST];
        let was = wide - change;
        let both = dot(abs(wide) + abs(was), vec3f(1.0 / 3.0));
        let variance = fresh.noise * both / (FILTER_PIXELS[WIDEST] * fresh.change.a * fresh.change.a);
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
