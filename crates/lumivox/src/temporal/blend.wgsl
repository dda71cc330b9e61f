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

// What this frame says about it.
struct Fresh {
    // Of the traced pixels around, openness in a.
    irradiance: vec4f,
    // The same after one step of the filter, and after all.
    fine: vec3f,
    wide: vec3f,
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
// Independent traced pixels in the filter's first step, and in the whole of it on a plain surface.
const FINE_PIXELS: f32 = 7.0;
const FILTER_PIXELS: f32 = 400.0;
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

// This frame's light without its noise: the wide filter's, and that of its first step as far as the two differ by more than
// noise, as in a penumbra.
fn filtered(fresh: Fresh, frames: f32) -> vec3f {
    let size = dot(abs(fresh.fine - fresh.wide), vec3f(1.0 / 3.0));
    // A few cones may sum up below zero.
    let both = dot(abs(fresh.fine) + abs(fresh.wide), vec3f(1.0 / 3.0));
    let variance = fresh.noise * both / FINE_PIXELS;
    let certain = max(1.0 - CERTAIN * CERTAIN * variance / max(size * size, 1e-20), 0.0);
    return mix(fresh.wide, fresh.fine, max(certain, frames / (1.0 + frames)));
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
        let both = dot(abs(fresh.wide) + abs(fresh.wide - change), vec3f(1.0 / 3.0));
        let variance = fresh.noise * both / (FILTER_PIXELS * fresh.change.a * fresh.change.a);
        let certain = max(1.0 - CERTAIN * CERTAIN * variance / max(size * size, 1e-20), 0.0);
        let was = fresh.wide - change;
        past = vec4f(shift(past.rgb, certain * change, was), past.a);
        let share = certain * size / max(dot(was, vec3f(1.0 / 3.0)), 1e-6);
        frames = frames_after_change(frames, share);
    }
    let share = FILTERED_FRAMES / (FILTERED_FRAMES + frames);
    let sample = mix(fresh.irradiance.rgb, filtered(fresh, frames), share);
    let weight = fresh.frames / (frames + 1.0);
    return Known(mix(past, vec4f(sample, fresh.irradiance.a), weight), max(frames + fresh.frames, 1.0));
}
