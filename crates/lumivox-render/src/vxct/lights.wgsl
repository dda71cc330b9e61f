// What lights send to a point in the look of VXCT, as the radiance of a white surface that faces them.
//
// VXCT's lights have a colour and fade by a polynomial. Theirs is an intensity at one metre here, so the colour is
// intensity / pi times the polynomial there. All other lights shine as they do: irradiance / pi.

import package::light::lights::{incident_light, lights};

// Constant, linear and quadratic attenuation by the distance in metres, and in w whether the light has one.
@group(1) @binding(1) var<storage, read> attenuations: array<vec4f>;

const PI: f32 = 3.14159265359;

struct Arriving {
    // Towards the light; unit length.
    direction: vec3f,
    distance_m: f32,
    radiance: vec3f,
    // What it would be without attenuation, if the light has a polynomial.
    color: vec3f,
    has_polynomial: bool,
}

fn arriving_light(index: u32, position_in_world: vec3f) -> Arriving {
    let light = lights[index];
    let incident = incident_light(light, position_in_world);
    let attenuation = attenuations[index];
    let has_polynomial = attenuation.w > 0.0;
    let color = light.intensity * (dot(attenuation.xyz, vec3f(1.0)) / PI);
    let d = distance(light.position_in_world, position_in_world);
    let faded = color / max(dot(attenuation.xyz, vec3f(1.0, d, d * d)), 1e-6);
    let radiance = select(incident.irradiance / PI, faded, has_polynomial);
    return Arriving(incident.direction, incident.distance_m, radiance, color, has_polynomial);
}
