// Reflection of emitters by a glossy lobe.
//
// A wide lobe rarely finds a small emitter, so points of emitters are drawn, too. The two ways of
// sampling are combined by the squares of both densities (the power heuristic: Veach and Guibas
// 1995, "Optimally combining sampling techniques for Monte Carlo rendering").

import package::emitters::draw::{draw_emitter, point_of, EmitterPoint};
import package::emitters::emitter::strength;
import package::emitters::gather::{candidate, trace_to};
import package::grid::grid_from_world;
import package::trace::brdf::{ggx_distribution, ggx_visibility, mirrored_density};
import package::trace::lobe::{fresnel_of, Lobe};
import package::trace::screen::settings;
import package::trace::surface::Surface;

// Number of emitter points from which the lobe's point is drawn, and number of points for the
// expected irradiance.
const REFLECTED: u32 = 4u;
const EXPECTING: u32 = 2u;

// Weight of lobe sampling for the light of a direction: `density` is the lobe's density, `emitted`
// approximately that of the emitters, both in 1/sr.
fn share_of_lobe(density: f32, emitted: f32) -> f32 {
    return density * density / max(density * density + emitted * emitted, 1e-30);
}

// The light of a point on an emitter that the lobe reflects to the camera, without occlusion, times
// the point's solid angle and the weight of emitter sampling. `expected` is approximately the
// irradiance from all emitters.
fn reflected_from(point: EmitterPoint, lobe: Lobe, normal_from_world: mat3x3f, geometric_normal: vec3f, expected: f32) -> vec3f {
    let light = normal_from_world * point.direction;
    if light.z <= 0.0 || dot(point.direction, geometric_normal) <= 0.0 || point.solid_angle <= 0.0 {
        return vec3f(0.0);
    }
    let half_vector = normalize(light + lobe.view);
    let brdf = fresnel_of(lobe, dot(lobe.view, half_vector))
        * (ggx_distribution(half_vector.z, lobe.alpha) * ggx_visibility(lobe.view.z, light.z, lobe.alpha));
    let density = mirrored_density(lobe.view.z, half_vector.z, lobe.alpha);
    let share = share_of_lobe(density, strength(point.radiance) * light.z / expected);
    return point.radiance * brdf * (light.z * point.solid_angle * (1.0 - share));
}

// Approximate irradiance from all emitters, without occlusion. It is deterministic for a place, so
// that both ways of sampling use the same weights.
fn expected_irradiance(surface: Surface) -> f32 {
    let place = grid_from_world(surface.position_in_world);
    var sum = 0.0;
    for (var i = 0u; i < EXPECTING; i++) {
        let point = point_of(draw_emitter(place, surface.geometric_normal, candidate(vec2f(0.5), i, EXPECTING)), place);
        sum += strength(point.radiance) * max(dot(point.direction, surface.geometric_normal), 0.0) * point.solid_angle;
    }
    return max(sum / f32(EXPECTING), 1e-20);
}

// Reflected light of sampled emitters, times the weight of emitter sampling: one of several points
// is kept, as in emitters/gather.wgsl. In a the samples of its ray.
fn reflect_emitters(
    surface: Surface,
    lobe: Lobe,
    normal_from_world: mat3x3f,
    level: u32,
    expected: f32,
    numbers: vec2f,
) -> vec4f {
    let place = grid_from_world(surface.position_in_world);
    var kept: EmitterPoint;
    var sum = 0.0;
    // A random number, rescaled to [0, 1) after each choice.
    var lot = fract(numbers.x * 4096.0);
    for (var i = 0u; i < REFLECTED; i++) {
        let point = point_of(draw_emitter(place, surface.geometric_normal, candidate(numbers, i, REFLECTED)), place);
        let brings = strength(reflected_from(point, lobe, normal_from_world, surface.geometric_normal, expected));
        sum += brings;
        let share = brings / max(sum, 1e-30);
        if brings > 0.0 && lot < share {
            kept = point;
            lot /= share;
        } else {
            lot = (lot - share) / max(1.0 - share, 1e-6);
        }
    }
    if sum <= 0.0 {
        return vec4f(0.0);
    }
    let traced = trace_to(kept, surface.position_in_world, surface.geometric_normal, level, settings.cones);
    let its = reflected_from(kept, lobe, normal_from_world, surface.geometric_normal, expected);
    let seen = traced.transmittance * sum / f32(REFLECTED);
    return vec4f(its * (seen / max(strength(its), 1e-30)), f32(traced.samples));
}
