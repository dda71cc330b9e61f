// One cone as a ray: the module package::cones::way. Those who trace cones draw their directions from the cones' solid angles,
// so that the mean of many is that over the cone.

import package::cascades::{outer_high, outer_low};
import package::cones::cone::{Cone, ConeSettings, OUTSIDE, START, Traced};
import package::cones::ray::{shown_by, trace_ray, NOTHING, Ray};
import package::grid::grid_from_world;

fn cone_start(position_in_world: vec3f, normal: vec3f, level: u32, settings: ConeSettings) -> vec3f {
    return grid_from_world(position_in_world) + normal * (START * exp2(f32(level)));
}

fn trace_cone(cone: Cone, settings: ConeSettings) -> Traced {
    var steps = 0u;
    let ray = Ray(cone.origin_in_grid, cone.direction, cone.reach, cone.level);
    let hit = trace_ray(ray, &steps);
    let extent = outer_high() - outer_low();
    let is_met = hit.face != NOTHING;
    return Traced(
        shown_by(hit.face),
        select(1.0, 0.0, is_met),
        select(1.0, 0.0, is_met && hit.distance < settings.occlusion_distance),
        steps,
        select(OUTSIDE * max(extent.x, max(extent.y, extent.z)), hit.distance, is_met),
    );
}
