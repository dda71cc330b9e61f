// Lights and the environment: group 2 of every pass that evaluates direct light or samples the
// environment.

import package::constants::{LIGHT_DIRECTIONAL, LIGHT_ENVIRONMENT, LIGHT_SPOT};

struct Light {
    position_in_world: vec3f,
    // LIGHT_DIRECTIONAL, LIGHT_POINT, LIGHT_SPOT or LIGHT_ENVIRONMENT.
    kind: u32,
    // The direction in which the light travels; unit length.
    direction: vec3f,
    // Distance at which the light ends, m; 0: never.
    range_m: f32,
    // Directional and environment: irradiance across the beam. Point and spot: radiant intensity.
    intensity: vec3f,
    // Point and spot: radius of the source, m. Directional and environment: tangent of its angular
    // radius.
    radius: f32,
    // Spot: the intensity is scaled by clamp(cos(angle) * spot_scale + spot_offset, 0, 1)^2.
    spot_scale: f32,
    spot_offset: f32,
    // SHADOW_NONE, SHADOW_MAP or SHADOW_CONE.
    shadow: u32,
    // First layer of the maps, for SHADOW_MAP; a point light has six, in the order +x -x +y -y +z
    // -z.
    shadow_layer: u32,
}

struct LightGlobals {
    // Factor of the environment map's values; without a map, the environment's radiance.
    environment: vec3f,
    light_count: u32,
    // Cosine and sine of the map's rotation about y.
    environment_turn: vec2f,
    // Lobes of a smaller alpha reflect the peaks in the environment map itself, and no highlights
    // of their lights.
    mirror_alpha: f32,
    padding: u32,
}

@group(2) @binding(0) var<uniform> light_globals: LightGlobals;
@group(2) @binding(1) var<storage, read> lights: array<Light>;

// A light's contribution at a point, without visibility.
struct Incident {
    // Towards the light; unit length.
    direction: vec3f,
    distance_m: f32,
    // Irradiance on a surface that faces the light.
    irradiance: vec3f,
}

// Whether a light's rays are parallel, since it is infinitely far away.
fn is_parallel(light: Light) -> bool {
    return light.kind == LIGHT_DIRECTIONAL || light.kind == LIGHT_ENVIRONMENT;
}

fn incident_light(light: Light, position_in_world: vec3f) -> Incident {
    if is_parallel(light) {
        return Incident(-light.direction, 3e38, light.intensity);
    }
    let to_light = light.position_in_world - position_in_world;
    // A point light is a sphere seen from outside: irradiance does not grow within its radius. The
    // floor keeps a light without radius finite.
    let floor_m = max(light.radius, 1e-3);
    let squared = max(dot(to_light, to_light), floor_m * floor_m);
    let distance_m = sqrt(squared);
    let direction = to_light / distance_m;
    var irradiance = light.intensity / squared;
    if light.range_m > 0.0 {
        // The window that glTF's KHR_lights_punctual recommends; Karis 2013, "Real shading in
        // Unreal Engine 4".
        let ratio = distance_m / light.range_m;
        irradiance *= clamp(1.0 - ratio * ratio * ratio * ratio, 0.0, 1.0);
    }
    if light.kind == LIGHT_SPOT {
        let cosine = dot(light.direction, -direction);
        let falloff = clamp(cosine * light.spot_scale + light.spot_offset, 0.0, 1.0);
        irradiance *= falloff * falloff;
    }
    return Incident(direction, distance_m, irradiance);
}
