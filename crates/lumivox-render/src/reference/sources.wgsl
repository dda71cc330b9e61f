// Next-event estimation: directions towards light sources are sampled, and each technique is
// weighted by its probability of finding that light, among all techniques (multiple importance
// sampling: Veach 1997, section 9.2, the power heuristic).

import package::constants::{
    BLOCKING, BOTH_SIDES, PI, REFERENCE_CANDIDATES, REFERENCE_HAS_LAYERS, REFERENCE_HAS_PANORAMA,
    TEXTURE_EMISSION, TRIANGLE_DOUBLE_SIDED,
};
import package::light::lights::{incident_light, is_parallel, Incident, Light};
import package::render::reference::intersect::{Hit, Ray};
import package::render::reference::panorama::{draw_surroundings, surroundings};
import package::render::reference::random::{random, random_2};
import package::render::reference::scatter::{cos_toward, scatter, Surface};
import package::render::reference::surface::{meet, texture_at};
import package::render::reference::world::{
    emitters, lights, materials, triangle_at, vertices, world, VERTEX_INDEX,
};
import package::trace::coat::below_coat;
import package::cones::hemisphere::basis;

// A visibility query: whether light arrives along a ray.
struct Question {
    direction: vec3f,
    reach: f32,
    sides: u32,
    // The light that is reflected towards the path if the ray is not blocked: light of lamps and of
    // the panorama's peaks, ...
    from_lights: vec3f,
    // ... and light of emitters and the rest of the panorama.
    from_surroundings: vec3f,
}

const NEVER: Question = Question(vec3f(0.0), 0.0, 0u, vec3f(0.0), vec3f(0.0));

fn brightness(color: vec3f) -> f32 {
    // ITU-R BT.709-6, section 3.2.
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// The weight of a technique of density `own` if the other technique has density `other`.
fn power_weight(own: f32, other: f32) -> f32 {
    // As a ratio, because squared densities overflow.
    let ratio = other / own;
    return 1.0 / (1.0 + ratio * ratio);
}

// The squared sine of half the angle that a light subtends; 0 for a point.
fn light_spread(light: Light, incident: Incident) -> f32 {
    let squared = light.radius * light.radius;
    if is_parallel(light) {
        return squared / (1.0 + squared);
    }
    return min(squared / (incident.distance_m * incident.distance_m), 1.0);
}

// 1 - cos of an angle, from its squared sine.
fn cap_height(spread: f32) -> f32 {
    return spread / (1.0 + sqrt(1.0 - spread));
}

// The length of a ray towards a light: up to the light's surface, minus the resolution of f32, so
// that a surface in the lamp's plane does not block it. `height` is 1 - cos of the angle to the
// light's centre.
fn light_reach(light: Light, incident: Incident, height: f32) -> f32 {
    if is_parallel(light) {
        return 3e38;
    }
    let aside = incident.distance_m * incident.distance_m * height * (2.0 - height);
    let depth = sqrt(max(light.radius * light.radius - aside, 0.0));
    return max(incident.distance_m * (1.0 - height) - depth - world.offset_m, 0.0);
}

// The light that a lamp sends to the offset origin of a surface's rays: aimed from the surface
// itself, rays would miss the lamp. Inside a lamp, the direction to its centre still has unit
// length.
fn light_at(index: u32, surface: Surface) -> Incident {
    let irradiance = incident_light(lights[index], surface.position).irradiance;
    let aimed = incident_light(lights[index], surface.position + surface.geometric * world.offset_m);
    let length = max(length(aimed.direction), 1e-20);
    return Incident(aimed.direction / length, aimed.distance_m, irradiance);
}

// The sum of the irradiance by each light on a surface that faces it.
fn all_lights(position: vec3f) -> f32 {
    var sum = 0.0;
    for (var index = 0u; index < world.light_count; index++) {
        sum += brightness(incident_light(lights[index], position).irradiance);
    }
    return sum;
}

// Samples a light in proportion to its irradiance on a surface that faces it, and a point on it.
fn ask_light(surface: Surface) -> Question {
    var sum = 0.0;
    var chosen = 0u;
    var chosen_brightness = 0.0;
    for (var index = 0u; index < world.light_count; index++) {
        let bright = brightness(incident_light(lights[index], surface.position).irradiance);
        sum += bright;
        // Reservoir sampling of one item (Chao 1982).
        if random() * sum < bright {
            chosen = index;
            chosen_brightness = bright;
        }
    }
    let place = random_2();
    if chosen_brightness <= 0.0 {
        return NEVER;
    }
    let probability = chosen_brightness / sum;
    let light = lights[chosen];
    let incident = light_at(chosen, surface);
    let spread = light_spread(light, incident);
    let height = place.x * cap_height(spread);
    let cosine = 1.0 - height;
    let sine = sqrt(height * (2.0 - height));
    let turn = 2.0 * PI * place.y;
    let drawn = basis(incident.direction) * vec3f(sine * cos(turn), sine * sin(turn), cosine);
    let direction = select(incident.direction, drawn, spread > 0.0);
    let scattered = scatter(surface, direction);
    // The disc is uniform. On a surface that faces it, it has the light's irradiance: pi sin^2
    // times its radiance.
    var weight = 1.0 / probability;
    if spread > 0.0 {
        let density = probability / (2.0 * PI * cap_height(spread));
        weight = power_weight(density, scattered.density) / (PI * spread * density);
    }
    let reflected = scattered.value * incident.irradiance * weight;
    return Question(direction, light_reach(light, incident, height), BOTH_SIDES, reflected, vec3f(0.0));
}

// The light whose disc a sampled direction hits; `weight` is BRDF times cosine over density.
fn ask_disc(surface: Surface, direction: vec3f, weight: vec3f, own_density: f32) -> Question {
    let sum = all_lights(surface.position);
    var count = 0.0;
    var question = NEVER;
    for (var index = 0u; index < world.light_count; index++) {
        let light = lights[index];
        let incident = light_at(index, surface);
        let spread = light_spread(light, incident);
        // From the chord: the cosine of a small angle rounds to one.
        let chord = direction - incident.direction;
        let height = 0.5 * dot(chord, chord);
        let bright = brightness(incident.irradiance);
        if spread > 0.0 && bright > 0.0 && height <= cap_height(spread) {
            count += 1.0;
            if random() * count < 1.0 {
                let density = bright / sum / (2.0 * PI * cap_height(spread));
                let radiance = incident.irradiance / (PI * spread);
                let reflected = weight * radiance * power_weight(own_density, density);
                let reach = light_reach(light, incident, height);
                question = Question(direction, reach, BOTH_SIDES, reflected, vec3f(0.0));
            }
        }
    }
    question.from_lights *= count;
    return question;
}

// The light that a point of a triangle sends along a direction.
fn emitted(triangle: u32, weights: vec2f, direction: vec3f) -> vec3f {
    if REFERENCE_HAS_LAYERS != 0u {
        let met = meet(Ray(vec3f(0.0), -direction, 0.0), Hit(0.0, triangle, weights, false), false);
        return met.coverage * met.emission * below_coat(met.surface.coat, cos_toward(met.surface));
    }
    let corners = triangle_at(triangle);
    let first = corners.vertex_0 & VERTEX_INDEX;
    let texcoords = (1.0 - weights.x - weights.y) * vertices[first].texcoords
        + weights.x * vertices[corners.vertex_1].texcoords
        + weights.y * vertices[corners.vertex_2].texcoords;
    let material = vertices[first].material;
    return materials[material].shown.emission * texture_at(material, TEXTURE_EMISSION, texcoords).rgb;
}

// The best of several points on emitters (resampled importance sampling: Talbot, Cline and Egbert
// 2005, "Importance resampling for global illumination"): of thousands of lamps only few matter at
// a point. Multiple importance sampling allows any density, if both techniques use the same: here,
// that of the candidates.
fn ask_emitter(surface: Surface) -> Question {
    var chosen = NEVER;
    var chosen_brightness = 0.0;
    var sum = 0.0;
    for (var candidate = 0u; candidate < REFERENCE_CANDIDATES; candidate++) {
        let question = ask_any_emitter(surface);
        if REFERENCE_CANDIDATES == 1u {
            return question;
        }
        let bright = brightness(question.from_surroundings);
        sum += bright;
        if random() * sum < bright {
            chosen = question;
            chosen_brightness = bright;
        }
    }
    if chosen_brightness > 0.0 {
        chosen.from_surroundings *= sum / (f32(REFERENCE_CANDIDATES) * chosen_brightness);
    }
    return chosen;
}

// A point of an emitter, sampled in proportion to area times mean radiance.
fn ask_any_emitter(surface: Surface) -> Question {
    let choice = random();
    let place = random_2();
    var index = 0u;
    var last = world.emitter_count - 1u;
    while index < last {
        let middle = (index + last) / 2u;
        let is_above = emitters[middle].cumulated > choice;
        last = select(last, middle, is_above);
        index = select(middle + 1u, index, is_above);
    }
    let triangle = emitters[index].triangle;
    // Uniform over the triangle (Turk 1990, "Generating random points in triangles").
    let root = sqrt(place.x);
    let weights = vec2f(root * (1.0 - place.y), root * place.y);
    let corners = triangle_at(triangle);
    let point = corners.corner + weights.x * corners.edge_1 + weights.y * corners.edge_2;
    let away = point - (surface.position + surface.geometric * world.offset_m);
    let distance = length(away);
    let direction = away / distance;
    let facing = -dot(direction, normalize(cross(corners.edge_1, corners.edge_2)));
    let is_front = facing > 0.0 || (corners.vertex_0 & TRIANGLE_DOUBLE_SIDED) != 0u;
    if !is_front || distance <= 0.0 {
        return NEVER;
    }
    let scattered = scatter(surface, direction);
    let first = corners.vertex_0 & VERTEX_INDEX;
    let per_area = materials[vertices[first].material].emitter_density;
    let density = per_area * distance * distance / max(abs(facing), 1e-8);
    let reflected = scattered.value * emitted(triangle, weights, -direction)
        * (power_weight(f32(REFERENCE_CANDIDATES) * density, scattered.density) / density);
    // The ray ends before the emitter, which must not block itself, by the same offset with which
    // rays start from their surface.
    let reach = distance - world.offset_m / max(abs(facing), 1e-8);
    return Question(direction, reach, BLOCKING, vec3f(0.0), reflected);
}

// The panorama without its peaks.
fn ask_panorama(surface: Surface) -> Question {
    let direction = draw_surroundings();
    let seen = surroundings(direction);
    let reflected = reflected_from(surface, direction, seen.density);
    return Question(direction, 3e38, BLOCKING, vec3f(0.0), reflected * seen.soft);
}

// A peak of the panorama: like other lights, it is blocked by both sides of surfaces.
fn ask_peak(surface: Surface) -> Question {
    let direction = draw_surroundings();
    let seen = surroundings(direction);
    let reflected = reflected_from(surface, direction, seen.density);
    return Question(direction, 3e38, BOTH_SIDES, reflected * seen.peaks, vec3f(0.0));
}

// The peak in a sampled direction; `weight` is BRDF times cosine over density.
fn ask_peak_along(direction: vec3f, weight: vec3f, own_density: f32) -> Question {
    let seen = surroundings(direction);
    let other = select(0.0, seen.density, REFERENCE_HAS_PANORAMA != 0u);
    let reflected = weight * seen.peaks * power_weight(own_density, other);
    return Question(direction, 3e38, BOTH_SIDES, reflected, vec3f(0.0));
}

// The light that a surface reflects for unit radiance from a direction sampled from the panorama.
fn reflected_from(surface: Surface, direction: vec3f, density: f32) -> vec3f {
    if density <= 0.0 {
        return vec3f(0.0);
    }
    let scattered = scatter(surface, direction);
    return scattered.value * (power_weight(density, scattered.density) / density);
}
