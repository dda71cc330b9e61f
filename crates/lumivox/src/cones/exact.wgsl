// One cone as a ray: the module package::cones::trace_method. Callers draw ray directions from the
// cone's solid angle, so that the mean of many rays is the mean over the cone.

import package::cascades::{outer_high, outer_low};
import package::cones::cone::{Cone, ConeSettings, MIN_GROWTH, OUTSIDE, START, Traced};
import package::cones::hemisphere::basis;
import package::cones::ray::{emitted_by, shown_by, trace_ray, Passed, Ray};
import package::gpu::random::hash;
import package::grid::grid_from_world;
import package::volume::patch::NOTHING;

fn cone_start(position_in_world: vec3f, normal: vec3f, level: u32, settings: ConeSettings) -> vec3f {
    return grid_from_world(position_in_world) + normal * (START * exp2(f32(level)));
}

// Maximum growth, per cosine to the plane that the cone starts from.
const MOST_GROWTH = 0.333;

// Number of rays to a source that is not a point.
const SHADOW_RAYS = 8u;

// The visible share of a source: rays over its disc, evenly distributed (Vogel 1979, "A better way
// to construct the sunflower head"), rotated by a hash of the position.
fn seen_share(
    position_in_world: vec3f,
    normal: vec3f,
    direction: vec3f,
    tan_half_angle: f32,
    reach: f32,
    level: u32,
) -> f32 {
    let offset = START * exp2(f32(level));
    let origin = grid_from_world(position_in_world) + normal * offset;
    let bits = bitcast<vec3u>(position_in_world);
    let turn = f32(hash(bits.x + hash(bits.y + hash(bits.z))) >> 8u) / 16777216.0;
    // Aim from the rays' start at the source's surface.
    let away = select(direction * reach - normal * offset, direction, reach > 1e30);
    let distance = select(length(away), reach, reach > 1e30);
    let across = basis(normalize(away));
    let rays = select(1u, SHADOW_RAYS, tan_half_angle > 1e-4);
    var seen = 0.0;
    for (var i = 0u; i < rays; i++) {
        let radius = tan_half_angle * sqrt((f32(i) + 0.5) / f32(rays));
        let angle = 2.39996323 * f32(i) + 6.28318530718 * turn;
        let aside = across * vec3f(radius * cos(angle), radius * sin(angle), 1.0);
        var passed = Passed(0u, false, 1.0);
        // Rays end before the source, which may lie in the plane of a surface.
        let hit = trace_ray(Ray(origin, normalize(aside), max(distance - offset, 0.0), level), &passed);
        seen += select(0.0, passed.share, hit.face == NOTHING);
    }
    return seen / f32(rays);
}

// The width of the environment's samples per distance, limited so that none reaches below the plane
// that the cone starts from.
fn cone_growth(tan_half_angle: f32, cos_normal: f32, settings: ConeSettings) -> f32 {
    let growth = 2.0 * tan_half_angle * settings.voxel_per_diameter;
    return max(min(growth, MOST_GROWTH * cos_normal), MIN_GROWTH);
}

fn trace_cone(cone: Cone, settings: ConeSettings) -> Traced {
    var passed = Passed(0u, true, 1.0);
    let ray = Ray(cone.origin_in_grid, cone.direction, cone.reach, cone.level);
    let hit = trace_ray(ray, &passed);
    let extent = outer_high() - outer_low();
    let is_met = hit.face != NOTHING;
    return Traced(
        shown_by(hit.face, false),
        select(1.0, 0.0, is_met),
        select(1.0, 0.0, is_met && hit.distance < settings.occlusion_distance),
        passed.steps,
        select(OUTSIDE * max(extent.x, max(extent.y, extent.z)), hit.distance, is_met),
        emitted_by(hit.face),
        emitted_by(hit.struck),
        hit.face,
    );
}
