// Irradiance at a point: the sum over the N cones of the hemisphere, each with the weight pi / N,
// plus the environment through their open share. Emitters are not seen if they are sampled instead.

import package::constants::PI;
import package::environment::environment_radiance;
import package::cones::cone::{Cone, ConeSettings};
import package::cones::trace_method::{cone_growth, cone_start, trace_cone};
import package::cones::hemisphere::{basis, cell_cone, cell_jitter};
import package::cones::model::place_in_cell;
import package::emitters::gather::has_emitters;

struct Gathered {
    irradiance: vec3f,
    // The cosine-weighted share of the hemisphere that is open up to the occlusion distance.
    openness: f32,
    samples: u32,
}

// `level` is the level of the voxels of the point's surface; `start` in [0, 1)^2 is the point's
// offset in the jitter sequence.
fn gather(
    position_in_world: vec3f,
    shading_normal: vec3f,
    geometric_normal: vec3f,
    level: u32,
    cone_count: u32,
    start: vec2f,
    frame: u32,
    settings: ConeSettings,
) -> Gathered {
    let origin = cone_start(position_in_world, geometric_normal, level, settings);
    let world_from_normal = basis(shading_normal);
    let jitter = cell_jitter(start, frame);
    // The cones of a point round their levels by evenly distributed numbers (golden ratio).
    let level_start = fract(start.x + start.y + 0.754878 * f32(frame & 0xffffu));
    let weight = PI / f32(cone_count);
    var sum = Gathered(vec3f(0.0), 0.0, 0u);
    for (var cell = 0u; cell < cone_count; cell++) {
        let place = place_in_cell(jitter, cell, cone_count, settings.model_values);
        let local = cell_cone(cell, cone_count, place);
        var direction = world_from_normal * local.direction;
        // With a normal map, a part of the hemisphere is below the surface; mirror directions there
        // up.
        let below = min(dot(direction, geometric_normal), 0.0);
        direction = direction - 2.0 * below * geometric_normal;
        let growth =
            cone_growth(local.tan_half_angle, dot(direction, geometric_normal), settings);
        let level_offset = fract(level_start + f32(cell) * 0.618034);
        let traced = trace_cone(Cone(origin, direction, growth, 3e38, level_offset, level), settings);
        let radiance = traced.radiance + select(traced.emission, vec3f(0.0), has_emitters());
        sum.irradiance += weight
            * (radiance + traced.transmittance * environment_radiance(direction, growth));
        sum.openness += traced.openness;
        sum.samples += traced.samples;
    }
    sum.openness = max(sum.openness / f32(cone_count), 0.0);
    return sum;
}
