// What lights send to a point in the look of VXCT, as the radiance of a white surface that faces them.
//
// VXCT's lights have a colour and fade by a polynomial. Theirs is an intensity at one metre here, so the colour is
// intensity / pi times the polynomial there. Other lamps get VXCT's default polynomial over distances in VXCT's units, which
// meets the inverse square at one unit; suns shine as they do: irradiance / pi.

import package::light::lights::{incident_light, lights};

// Constant, linear and quadratic attenuation by the distance in metres, and in w what the intensity is multiplied by for
// pi times the colour: below zero for lamps that are not VXCT's own, zero for suns.
@group(1) @binding(1) var<storage, read> attenuations: array<vec4f>;

const PI: f32 = 3.14159265359;

struct Arriving {
    // Towards the light; unit length.
    direction: vec3f,
    distance_m: f32,
    radiance: vec3f,
    // What it would be without attenuation, but for suns.
    color: vec3f,
    is_lamp: bool,
    // Whether the scene's file gave its attenuation.
    is_vxct: bool,
}

fn arriving_light(index: u32, position_in_world: vec3f) -> Arriving {
    let light = lights[index];
    let incident = incident_light(light, position_in_world);
    let attenuation = attenuations[index];
    let is_lamp = attenuation.w != 0.0;
    let d = distance(light.position_in_world, position_in_world);
    // A spot's cone and a range stay: what is left of the irradiance without the inverse square.
    let sent = max(light.intensity.r, max(light.intensity.g, light.intensity.b));
    let arrived = max(incident.irradiance.r, max(incident.irradiance.g, incident.irradiance.b));
    let shape = min(arrived * d * d / max(sent, 1e-30), 1.0);
    let color = light.intensity * (abs(attenuation.w) / PI * shape);
    let faded = color / max(dot(attenuation.xyz, vec3f(1.0, d, d * d)), 1e-6);
    let radiance = select(incident.irradiance / PI, faded, is_lamp);
    let is_vxct = attenuation.w > 0.0;
    return Arriving(incident.direction, incident.distance_m, radiance, color, is_lamp, is_vxct);
}
