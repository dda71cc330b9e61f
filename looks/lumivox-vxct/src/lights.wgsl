// Lights, which fade by a polynomial or not at all.

import package::vxct::material::VxctMaterial;

struct VxctLight {
    // Position in the cube; for parallel light, the unit vector towards it.
    position: vec3f,
    is_parallel: u32,
    // The colour, as a share of white, of a white surface that faces the light, before the light
    // fades.
    color: vec3f,
    spot_scale: f32,
    // The direction of a spot light.
    spot_direction: vec3f,
    // A spot's share is (cosine * scale + offset)^2, clamped to 0 to 1; scale 0 and offset 1 for
    // other lights.
    spot_offset: f32,
    // Constant, linear and quadratic coefficient.
    attenuation: vec3f,
    padding: u32,
}

@group(0) @binding(3) var<storage, read> vxct_lights: array<VxctLight>;

struct Arriving {
    // Towards the light.
    direction: vec3f,
    distance: f32,
    // The light's colour at the source, and at the surface.
    sent: vec3f,
    color: vec3f,
}

// Shadows of parallel light are softened as if the light were at this distance.
const DISTANCE_OF_PARALLEL_LIGHT: f32 = 1.0;

fn arriving_light(index: u32, position: vec3f) -> Arriving {
    let light = vxct_lights[index];
    if light.is_parallel != 0u {
        return Arriving(light.position, DISTANCE_OF_PARALLEL_LIGHT, light.color, light.color);
    }
    let way = light.position - position;
    let distance = length(way);
    let direction = way / max(distance, 1e-12);
    let inside = saturate(dot(-direction, light.spot_direction) * light.spot_scale + light.spot_offset);
    let sent = light.color * (inside * inside);
    let fading = dot(light.attenuation, vec3f(1.0, distance, distance * distance));
    return Arriving(direction, distance, sent, sent / fading);
}

// The light that is stored in the voxels: neither faded nor shadowed.
fn injected(material: VxctMaterial, normal: vec3f, arriving: Arriving) -> vec3f {
    let facing = max(dot(normal, arriving.direction), 0.0);
    return (material.ambient + material.diffuse * facing) * arriving.sent;
}
