// The share of a light that reaches a point: from a shadow map, or by a cone as wide as the source.

import package::cascades::finest_level;
import package::constants::{SHADOW_MAP, SHADOW_NONE};
import package::grid::{grid, grid_from_world};
import package::light::lights::{is_parallel, Incident, Light};
import package::light::shadow_map::shadow_map_visibility;
import package::cones::cone::{cone_growth, Cone, ConeSettings};
import package::cones::way::trace_cone;

// Shadow cones are narrow, so cells of half their diameter do, and they start a voxel and a half off the
// surface: a light at a grazing angle would meet the receiver's own neighbourhood otherwise.
fn shadow_cone_settings() -> ConeSettings {
    var settings = ConeSettings();
    settings.voxel_per_diameter = 0.5;
    settings.normal_offset = 1.5;
    settings.step_per_voxel = 1.0;
    settings.min_transmittance = 0.004;
    settings.occlusion_distance = 3e38;
    return settings;
}

fn shadow_cone_visibility(
    light: Light,
    incident: Incident,
    position_in_world: vec3f,
    normal: vec3f,
    level: u32,
) -> f32 {
    let settings = shadow_cone_settings();
    let voxel = exp2(f32(level));
    var tan_half_angle = light.radius;
    var reach = 3e38;
    if !is_parallel(light) {
        tan_half_angle = light.radius / max(incident.distance_m, light.radius);
        // Not into the source itself, nor into what carries it.
        reach = (incident.distance_m - light.radius) / grid.voxel_size_m - 2.0 * voxel;
    }
    let origin = grid_from_world(position_in_world) + normal * (voxel * settings.normal_offset);
    let growth = cone_growth(tan_half_angle, 1.0, settings);
    let cone = Cone(origin, incident.direction, growth, reach, 0.5, level);
    return max(trace_cone(cone, settings).transmittance, 0.0);
}

// At a surface, which may have voxels of several cascades.
fn light_visibility(
    light: Light,
    incident: Incident,
    position_in_world: vec3f,
    normal: vec3f,
) -> f32 {
    let level = finest_level(grid_from_world(position_in_world), 0u, 2.0);
    return light_visibility_from(light, incident, position_in_world, normal, level);
}

// At a place whose surface is that of voxels of a level.
fn light_visibility_from(
    light: Light,
    incident: Incident,
    position_in_world: vec3f,
    normal: vec3f,
    level: u32,
) -> f32 {
    if light.shadow == SHADOW_MAP {
        let visible = shadow_map_visibility(light, position_in_world, normal);
        // Maps of a caller's own need not reach everywhere.
        if visible >= 0.0 {
            return visible;
        }
    }
    if light.shadow != SHADOW_NONE {
        return shadow_cone_visibility(light, incident, position_in_world, normal, level);
    }
    return 1.0;
}
