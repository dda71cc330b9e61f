// Direct irradiance at a place from emitters.
//
// Some of several candidates are kept, in proportion to their contributions without occlusion
// (resampled importance sampling: Talbot et al. 2005, "Importance resampling for global
// illumination"), and rays test their visibility. The mean over frames is exact, except for
// occlusion by voxel faces.

import package::cascades::finest_level;
import package::cones::cone::{Cone, ConeSettings, START, Traced};
import package::cones::trace_method::{cone_start, trace_cone};
import package::constants::SAMPLES_EMITTERS;
import package::emitters::draw::{
    draw_emitter, emitters, point_of, root_importances, EmitterPoint,
};
import package::emitters::emitter::{distance_to, emitter_of, NEIGHBOURS, strength};
import package::grid::grid_from_world;

const CANDIDATES: u32 = 8u;

// Increments of a place's two random numbers from turn to turn. The first number times CANDIDATES
// (8) places the candidates within their strata: of all increments, 0.46803 and its eightfold have
// the least discrepancy of their first 4 to 128 multiples. (The sequence of cones has 0.7549, whose
// eightfold, 6.039, advances by only 1/25.) The second increment is that of the cones.
const TURN_STEPS: vec2f = vec2f(0.46803, 0.7548776662);

// Candidates with a smaller share of the sum of the weights are not kept.
const LEAST_SHARE: f32 = 1e-6;

struct FromEmitters {
    irradiance: vec3f,
    samples: u32,
}

// Whether emitters are sampled. Kernels for geometry without emitters omit code that depends on it.
fn has_emitters() -> bool {
    if SAMPLES_EMITTERS == 0u {
        return false;
    }
    return emitters.count > 0u && emitters.is_shown == 0u;
}

// The hue of a radiance as an integer: 0 for blue, HUES for red.
const HUES = 65535.0;

fn hue_of(radiance: vec3f) -> u32 {
    let hue = (radiance.r - radiance.b) / max(strength(radiance), 1e-30);
    return u32((0.5 + hue / 6.0) * HUES);
}

// Settings of shadow rays, which are narrow: shadows are soft because points are spread over the
// emitter.
fn ray_settings(settings: ConeSettings) -> ConeSettings {
    var ray = settings;
    ray.step_per_voxel = 1.0;
    ray.occlusion_distance = 3e38;
    return ray;
}

// The cosine at which light arrives; light from below the surface is mirrored up, like cones
// (cones::gather).
fn folded_cosine(direction: vec3f, shading_normal: vec3f, geometric_normal: vec3f) -> f32 {
    let above = dot(direction, geometric_normal);
    if above <= 0.0 {
        return 0.0;
    }
    let mirrored = direction - 2.0 * above * geometric_normal;
    return max(dot(direction, shading_normal), 0.0) + max(dot(mirrored, shading_normal), 0.0);
}

// The random numbers of candidate `index` of `count`: each candidate has its own stratum of the
// first number, and all the same place within it.
fn candidate(numbers: vec2f, index: u32, count: u32) -> vec2f {
    let parts = f32(count);
    return vec2f(
        (f32(index) + fract(numbers.x * parts)) / parts,
        fract(numbers.y + 0.618034 * f32(index)),
    );
}

// The cover of a face reaches up to an eighth of a voxel beyond the surface, so that the faces of a
// lamp thinner than a voxel hide its other sides. If a ray ends on the lamp within this distance of
// the point, in voxels, occlusion is tested with triangles instead.
const OWN: f32 = 1.0;

// The range of a face's radiance divided by the point's in which the face counts as the lamp's.
const LIKE_OWN: vec2f = vec2f(0.5, 2.0);

// Whether a point is hidden by an emitter near its own in the list.
fn is_hidden(point: EmitterPoint) -> bool {
    var is_met = false;
    let end = min(point.index + NEIGHBOURS + 1u, emitters.count);
    for (var i = max(point.index, NEIGHBOURS) - NEIGHBOURS; i < end; i++) {
        let distance = distance_to(emitter_of(emitters.records[i]), point.position, -point.direction);
        is_met |= i != point.index && distance < point.distance;
    }
    return is_met;
}

// Traces a ray from a place to a point of an emitter.
fn trace_to(
    point: EmitterPoint,
    position_in_world: vec3f,
    geometric_normal: vec3f,
    level: u32,
    settings: ConeSettings,
) -> Traced {
    let origin = cone_start(position_in_world, geometric_normal, level, settings);
    // The ray ends just in front of the emitter.
    let at_emitter = finest_level(point.position, level, 2.0);
    let to_point = point.position + START * exp2(f32(at_emitter)) * point.normal - origin;
    let distance = length(to_point);
    let ray = Cone(origin, to_point / max(distance, 1e-6), 0.0, distance, 0.0, level);
    var traced = trace_cone(ray, ray_settings(settings));
    let ratio = strength(traced.emission_of_face) / max(strength(point.radiance), 1e-30);
    let ends_on_own = ratio > LIKE_OWN.x && ratio < LIKE_OWN.y
        && traced.distance > distance - OWN * exp2(f32(at_emitter));
    if ends_on_own && !point.is_double_sided {
        traced.transmittance = select(1.0, 0.0, is_hidden(point));
    }
    return traced;
}

// `level` is the level of the voxels of the place's surface, `start` in [0, 1)^2 is the place's
// offset in the sequence, and `turn` the index in it. `rays` is the number of candidates that are
// kept: in soft shadows, the rays of a place end in different parts of the lamp.
fn gather_emitters(
    position_in_world: vec3f,
    shading_normal: vec3f,
    geometric_normal: vec3f,
    level: u32,
    start: vec2f,
    turn: u32,
    rays: u32,
    settings: ConeSettings,
) -> FromEmitters {
    var result = FromEmitters(vec3f(0.0), 0u);
    if !has_emitters() {
        return result;
    }
    let place = grid_from_world(position_in_world);
    let numbers = fract(start + fract(TURN_STEPS * f32(turn & 0xffffu)));
    var weights: array<f32, CANDIDATES>;
    // Numbers that sort the candidates by hue from blue to red.
    var hues: array<u32, CANDIDATES>;
    var sum = 0.0;
    let root = root_importances(place, geometric_normal);
    for (var i = 0u; i < CANDIDATES; i++) {
        let drawn = draw_emitter(place, geometric_normal, candidate(numbers, i, CANDIDATES), root);
        let point = point_of(drawn, place);
        let cosine = folded_cosine(point.direction, shading_normal, geometric_normal);
        weights[i] = strength(point.radiance) * cosine * point.solid_angle;
        sum += weights[i];
        hues[i] = hue_of(point.radiance) * CANDIDATES + i;
    }
    if sum <= 0.0 {
        return result;
    }
    // Candidates that bring next to nothing are never kept: rounding would give them the shares of
    // others.
    for (var i = 0u; i < CANDIDATES; i++) {
        weights[i] = select(0.0, weights[i], weights[i] > LEAST_SHARE * sum);
    }
    // The sum of the weights of all candidates before one.
    var starts: array<f32, CANDIDATES>;
    for (var i = 0u; i < CANDIDATES; i++) {
        starts[i] = select(2.0 * sum, 0.0, weights[i] > 0.0);
        for (var j = 0u; j < CANDIDATES; j++) {
            starts[i] += select(0.0, weights[j], hues[j] < hues[i]);
        }
    }
    // Evenly spaced numbers choose the candidates. Other digits of `start` make the choice
    // independent of the candidates' place within their strata.
    let first = fract(numbers.x + fract(start.x * 4096.0));
    for (var ray = 0u; ray < rays; ray++) {
        let lot = sum * fract(first + f32(ray) / f32(rays));
        var index = 0u;
        var latest = -1.0;
        for (var i = 0u; i < CANDIDATES; i++) {
            if starts[i] <= lot && starts[i] > latest {
                latest = starts[i];
                index = i;
            }
        }
        let again = draw_emitter(place, geometric_normal, candidate(numbers, index, CANDIDATES), root);
        let kept = point_of(again, place);
        let traced = trace_to(kept, position_in_world, geometric_normal, level, settings);
        let seen = sum / f32(CANDIDATES * rays) * traced.transmittance;
        result.irradiance += kept.radiance * (seen / strength(kept.radiance));
        result.samples += traced.samples;
    }
    return result;
}
