// Light of earlier frames for the surface at a pixel, read at the surface's place in the previous
// frame's picture.
//
// The four texels around that place are weighted bilinearly and by their fit to the surface. A
// surface that has not moved in the picture uses its own texel, which avoids blur. If none of the
// four fits, as at the border of an object when the picture is jittered within the pixels, the best
// of the neighbours is used.

import package::grid::world_from_grid;
import package::temporal::blend::FRAMES_OF_CHANGE;
import package::temporal::guide::guide_normal;
import package::temporal::past::{
    former_place, past_irradiance, past_records, past_size, past_specular, texel_fit, SAME_SURFACE,
};
import package::temporal::record::decode_record;
import package::temporal::reflection::recall_reflection;
import package::trace::fit::fit;
import package::trace::gbuffer::{load_motion, load_surface};
import package::trace::screen::settings;
import package::trace::surface::Surface;
import package::trace::view::{camera_motion, view};
import package::voxelize::reproducible::is_finite;

@group(1) @binding(4) var irradiance_out: texture_storage_2d<rgba16float, write>;
// Reflection in rgb. In a the number of frames: 0 if no light is known, negative if the place of
// the reflection's image was not found.
@group(1) @binding(5) var specular_out: texture_storage_2d<rgba16float, write>;
// Traced pixels of the last frame: their surfaces, and the old and new light of probes near them.
@group(1) @binding(6) var past_guides: texture_2d<f32>;
@group(1) @binding(7) var probes_were: texture_2d<f32>;
@group(1) @binding(8) var probes_are: texture_2d<f32>;

// Tolerance for places at the center of a texel, in texels, for rounding of matrices.
const SAME_TEXEL: f32 = 0.01;
// Texels with less total weight than this are ignored.
const LEAST_WEIGHT: f32 = 0.1;
// Distance by which a moved object may be off its former plane, in voxels.
const MOVED_SLACK: f32 = 4.0;

// Maximum frames in the mean of a surface that moves in the picture: each look-up between texels
// blurs it a little.
const MOVING_FRAMES: f32 = 32.0;

// Frame count of light if no probe shows how it has changed.
const UNKNOWN_FRAMES: f32 = 4.0;

// If changed light counts for fewer frames than this, reflections have changed, too.
const CHANGED_FRAMES: f32 = 64.0;

// Maximum factor by which brighter light is scaled, which keeps its detail; the excess is added
// uniformly.
const MOST_BRIGHTER: f32 = 4.0;

struct Recalled {
    irradiance: vec4f,
    specular: vec3f,
    frames: f32,
    weights: f32,
    is_same_texel: bool,
    // Whether the reflection was found at its image's place, in light that has hardly changed.
    is_image: bool,
}

fn add(recalled: ptr<function, Recalled>, texel: vec2i, weight: f32) {
    let record = decode_record(textureLoad(past_records, texel, 0).xy);
    let irradiance = textureLoad(past_irradiance, texel, 0);
    let specular = textureLoad(past_specular, texel, 0).rgb;
    if !is_finite(irradiance.rgb) || !is_finite(specular) {
        return;
    }
    (*recalled).irradiance += weight * irradiance;
    (*recalled).specular += weight * specular;
    (*recalled).frames += weight * record.frames;
    (*recalled).weights += weight;
}

struct Drifted {
    light: vec3f,
    // Maximum frame count for this light.
    most_frames: f32,
}

// Known light of a place in the last frame, updated by its change since then.
fn drift(light: vec3f, place: vec2f, surface: Surface, slack: f32) -> Drifted {
    let small = place / f32(settings.scale);
    let last = vec2i(textureDimensions(past_guides)) - 1;
    var was = vec3f(0.0);
    var now = vec3f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let texel = clamp(vec2i(floor(small)) + vec2i(i & 1, i >> 1), vec2i(0), last);
        let guide = textureLoad(past_guides, texel, 0);
        if guide.w < 0.0 {
            continue;
        }
        let offset = world_from_grid(guide.xyz) - surface.position_in_world;
        let were = textureLoad(probes_were, texel, 0);
        let weight = were.a * fit(offset / slack, guide_normal(guide), surface);
        was += weight * were.rgb;
        now += weight * textureLoad(probes_are, texel, 0).rgb;
        weights += weight;
    }
    if weights < LEAST_WEIGHT {
        return Drifted(light, UNKNOWN_FRAMES);
    }
    let scale = clamp(now / max(was, vec3f(1e-6)), vec3f(0.0), vec3f(MOST_BRIGHTER));
    let drifted = scale * light + max(now - MOST_BRIGHTER * was, vec3f(0.0)) / weights;
    let change = dot(abs(now - was), vec3f(1.0)) / max(dot(was, vec3f(1.0)), 1e-6);
    return Drifted(drifted, FRAMES_OF_CHANGE / max(change * change, 1e-6));
}

fn recall(pixel: vec2u, surface: Surface) -> Recalled {
    var recalled = Recalled(vec4f(0.0), vec3f(0.0), 0.0, 0.0, false, false);
    let motion = load_motion(pixel, surface.position_in_world);
    let own_motion = motion - camera_motion(pixel, surface.position_in_world);
    let slack = select(1.0, MOVED_SLACK, any(abs(own_motion) * vec2f(view.size) > vec2f(SAME_TEXEL)));
    let exact = former_place(pixel, motion);
    let nearest = round(exact);
    // Coordinates far outside may not fit into an integer.
    if !(all(exact > vec2f(-2.0)) && all(exact < past_size() + 1.0)) {
        return recalled;
    }
    let is_same = all(abs(exact - nearest) < vec2f(SAME_TEXEL));
    recalled.is_same_texel = is_same;
    let place = select(exact, nearest, is_same);
    let corner = vec2i(floor(place));
    let fraction = place - floor(place);
    // Software drivers run both sides of conditions, but end a loop that tests at its end once no
    // pixel needs it.
    let taps = select(4, 1, is_same);
    var tap = 0;
    loop {
        let offset = vec2i(tap & 1, tap >> 1);
        let share = abs(vec2f(1 - offset) - fraction);
        let bilinear = share.x * share.y;
        if bilinear > 1e-3 {
            let weight = bilinear * texel_fit(corner + offset, surface, slack);
            if weight > 1e-3 {
                add(&recalled, corner + offset, weight);
            }
        }
        tap += 1;
        continuing {
            break if tap >= taps;
        }
    }
    if recalled.weights < LEAST_WEIGHT {
        recalled = Recalled(vec4f(0.0), vec3f(0.0), 0.0, 0.0, is_same, false);
        var best = SAME_SURFACE;
        var best_texel = vec2i(0);
        var beside = 0;
        loop {
            let texel = vec2i(nearest) + vec2i(beside % 3 - 1, beside / 3 - 1);
            let fits = texel_fit(texel, surface, slack);
            if fits > best {
                best = fits;
                best_texel = texel;
            }
            beside += 1;
            continuing {
                break if beside >= 9;
            }
        }
        if best > SAME_SURFACE {
            add(&recalled, best_texel, 1.0);
        }
    }
    if recalled.weights > 0.0 {
        let reflection = recall_reflection(pixel, surface, own_motion, slack);
        if reflection.a > 0.5 {
            recalled.specular = recalled.weights * reflection.rgb;
            recalled.is_image = true;
        }
    }
    if recalled.weights > 0.0 && settings.has_changed != 0u {
        let light = recalled.irradiance.rgb / recalled.weights;
        let drifted = drift(light, exact, surface, slack);
        recalled.irradiance = vec4f(recalled.weights * drifted.light, recalled.irradiance.a);
        // Variances add up.
        let most = drifted.most_frames * recalled.weights;
        recalled.is_image = recalled.is_image && drifted.most_frames > CHANGED_FRAMES;
        recalled.frames = recalled.frames * most / (recalled.frames + most);
    }
    return recalled;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    var irradiance = vec4f(0.0);
    var specular = vec4f(0.0);
    if surface.depth > 0.0 && settings.remembers != 0u {
        let recalled = recall(pixel, surface);
        if recalled.weights > 0.0 {
            irradiance = recalled.irradiance / recalled.weights;
            specular = vec4f(recalled.specular, recalled.frames) / recalled.weights;
            if !recalled.is_same_texel {
                specular.a = min(specular.a, MOVING_FRAMES);
            }
            specular.a = select(-specular.a, specular.a, recalled.is_image);
        }
    }
    textureStore(irradiance_out, pixel, irradiance);
    textureStore(specular_out, pixel, specular);
}
