// The share of a light that reaches a point: from a shadow map, or by rays to the source.

import package::cascades::finest_level;
import package::constants::{SHADOW_MAP, SHADOW_NONE, TRACES_SHADOWS};
import package::grid::{grid, grid_from_world};
import package::cones::trace_method::seen_share;
import package::light::lights::{is_parallel, Incident, Light};
import package::light::shadow_map::shadow_map_visibility;

fn shadow_cone_visibility(
    light: Light,
    incident: Incident,
    position_in_world: vec3f,
    normal: vec3f,
    level: u32,
) -> f32 {
    var tan_half_angle = light.radius;
    var reach = 3e38;
    if !is_parallel(light) {
        tan_half_angle = light.radius / max(incident.distance_m, light.radius);
        // The ray ends in front of the source.
        reach = (incident.distance_m - light.radius) / grid.voxel_size_m;
    }
    return seen_share(position_in_world, normal, incident.direction, tan_half_angle, reach, level);
}

// Visibility at a surface, whose voxels may be of several cascades.
fn light_visibility(
    light: Light,
    incident: Incident,
    position_in_world: vec3f,
    normal: vec3f,
) -> f32 {
    let level = finest_level(grid_from_world(position_in_world), 0u, 2.0);
    return light_visibility_from(light, incident, position_in_world, normal, level);
}

// Visibility at a place whose surface has voxels of the given level.
fn light_visibility_from(
    light: Light,
    incident: Incident,
    position_in_world: vec3f,
    normal: vec3f,
    level: u32,
) -> f32 {
    if light.shadow == SHADOW_MAP {
        let visible = shadow_map_visibility(light, position_in_world, normal);
        // A caller's own maps may not cover everything.
        if visible >= 0.0 {
            return visible;
        }
    }
    // Kernels for lights that all have maps omit the rays.
    if TRACES_SHADOWS != 0u && light.shadow != SHADOW_NONE {
        return shadow_cone_visibility(light, incident, position_in_world, normal, level);
    }
    return 1.0;
}
