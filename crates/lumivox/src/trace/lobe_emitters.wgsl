// Reflection of emitters by a glossy lobe. Points drawn on a large emitter are rarely in a narrow
// lobe, and draws of a wide lobe rarely hit a small emitter. Both ways of sampling are combined by
// the squares of their densities (the power heuristic: Veach and Guibas 1995, "Optimally combining
// sampling techniques for Monte Carlo rendering").

import package::emitters::along::{emitter_along, point_along, Met};
import package::emitters::draw::{draw_emitter, emitters, point_of, root_importances, EmitterPoint};
import package::emitters::emitter::{emitter_of, strength, tree_levels, FAR};
import package::emitters::gather::{candidate, trace_to};
import package::grid::grid_from_world;
import package::trace::brdf::{ggx_distribution, ggx_visibility, mirrored_density};
import package::trace::lobe::{draw_in_grid, fresnel_of, Lobe, GRID};
import package::trace::screen::settings;
import package::trace::surface::Surface;

// Number of points drawn on emitters, and number of points for the expected irradiance.
const REFLECTED: u32 = 4u;
const EXPECTING: u32 = 2u;

// Searches of a tree with more levels take long, so fewer draws of the lobe look for emitters.
const FEW_LEVELS: u32 = 6u;

// The number of draws of a lobe that look for emitters, in each column of the grid.
fn draws_in_column() -> u32 {
    return select(1u, GRID, tree_levels(emitters.count) <= FEW_LEVELS);
}

// Weight of lobe sampling for the light of a direction: `density` is the lobe's density, `emitted`
// the approximate density of emitter sampling, 1/sr.
fn share_of_lobe(density: f32, emitted: f32) -> f32 {
    let by_lobe = f32(GRID * draws_in_column()) * density;
    let by_points = f32(REFLECTED) * emitted;
    return by_lobe * by_lobe / max(by_lobe * by_lobe + by_points * by_points, 1e-30);
}

// The light of a point on an emitter that the lobe reflects to the camera, without occlusion, times
// the point's solid angle and the weight of emitter sampling. `expected` is the approximate
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
    let root = root_importances(place, surface.geometric_normal);
    var sum = 0.0;
    for (var i = 0u; i < EXPECTING; i++) {
        let numbers = candidate(vec2f(0.5), i, EXPECTING);
        let point = point_of(draw_emitter(place, surface.geometric_normal, numbers, root), place);
        sum += strength(point.radiance) * max(dot(point.direction, surface.geometric_normal), 0.0) * point.solid_angle;
    }
    return max(sum / f32(EXPECTING), 1e-20);
}

// A choice among points on emitters, in proportion to the light that the lobe reflects from them
// without occlusion.
struct Choice {
    met: Met,
    direction: vec3f,
    // The light that the lobe reflects from the chosen point.
    light: vec3f,
    // The sum of the strengths of the light from all points.
    sum: f32,
    // A random number, rescaled to [0, 1) after each offer.
    lot: f32,
}

fn offer(choice: Choice, met: Met, direction: vec3f, light: vec3f) -> Choice {
    let brings = strength(light);
    var next = choice;
    next.sum += brings;
    let share = brings / max(next.sum, 1e-30);
    if brings > 0.0 && choice.lot < share {
        next.met = met;
        next.direction = direction;
        next.light = light;
        next.lot /= share;
    } else {
        next.lot = (next.lot - share) / max(1.0 - share, 1e-6);
    }
    return next;
}

// The light of emitters that the lobe reflects in rgb; the samples of its ray in a. Draws of the
// lobe that hit an emitter, and several points on emitters, estimate the light without occlusion; a
// ray to one of them tests visibility. `draws` are the random numbers of the lobe's draws,
// `numbers` those of the points.
fn reflect_emitters(
    surface: Surface,
    lobe: Lobe,
    world_from_normal: mat3x3f,
    level: u32,
    expected: f32,
    draws: vec2f,
    numbers: vec2f,
) -> vec4f {
    let place = grid_from_world(surface.position_in_world);
    var choice = Choice(Met(0u, FAR), vec3f(0.0), vec3f(0.0), 0.0, fract(numbers.x * 4096.0));
    let rows = draws_in_column();
    // Each frame starts at a random row.
    let first_row = u32(draws.y * f32(GRID));
    for (var i = 0u; i < GRID * rows; i++) {
        let drawn = draw_in_grid(lobe, draws, GRID * (i / rows) + (first_row + i) % GRID);
        let direction = world_from_normal * drawn.direction;
        if drawn.direction.z > 0.0 && dot(direction, surface.geometric_normal) > 0.0 {
            let met = emitter_along(place, direction);
            if met.distance < FAR {
                let radiance = emitter_of(emitters.records[met.index]).radiance;
                let share = share_of_lobe(drawn.density, strength(radiance) * drawn.direction.z / expected);
                choice = offer(choice, met, direction, radiance * drawn.weight * (share / f32(GRID * rows)));
            }
        }
    }
    let normal_from_world = transpose(world_from_normal);
    let root = root_importances(place, surface.geometric_normal);
    for (var i = 0u; i < REFLECTED; i++) {
        let own = candidate(numbers, i, REFLECTED);
        let point = point_of(draw_emitter(place, surface.geometric_normal, own, root), place);
        let light = reflected_from(point, lobe, normal_from_world, surface.geometric_normal, expected);
        choice = offer(choice, Met(point.index, point.distance), point.direction, light / f32(REFLECTED));
    }
    if choice.sum <= 0.0 {
        return vec4f(0.0);
    }
    let kept = point_along(choice.met, place, choice.direction);
    let traced = trace_to(kept, surface.position_in_world, surface.geometric_normal, level, settings.cones);
    let seen = traced.transmittance * choice.sum / strength(choice.light);
    return vec4f(choice.light * seen, f32(traced.samples));
}
