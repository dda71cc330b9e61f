// A path tracer: unbiased, with unlimited bounces by default. It traces one sample of every pixel
// at a time.
//
// Two paths start in each sample: one for the picture, with the real materials, and one for the
// irradiance of the visible surface, which is treated as white and diffuse: its radiance is then
// irradiance / pi. Light is classified by its path. Lamps and the peaks of the panorama count as
// *lights*; the light of emissive surfaces and of the rest of the panorama reaches surfaces through
// *gathers*, like reflected light. So the layers match the renderer's: direct light comes from
// lights; one bounce is the light that one gather finds. With sensors, one path starts at each of
// them; its direct light also comes from lights.
//
// A path ends at random, with a probability that depends on the light that it could still
// contribute (Russian roulette: Arvo and Kirk 1990, "Particle transport and image synthesis").

import package::constants::{
    AS_SEEN, BLOCKING, NO_TRIANGLE, REFERENCE_CANDIDATES, REFERENCE_HAS_DISCS,
    REFERENCE_HAS_EMITTERS, REFERENCE_HAS_LIGHTS, REFERENCE_HAS_PANORAMA, REFERENCE_HAS_PEAKS,
    REFERENCE_HAS_SENSORS, REFERENCE_SEE_THROUGH,
};
import package::render::reference::intersect::{intersect, ray_from, Hit, Ray};
import package::render::reference::panorama::surroundings;
import package::render::reference::random::{random, random_2, start_random};
import package::render::reference::scatter::{cos_toward, draw_direction, scatter};
import package::render::reference::sensors::{sensor_at, white_sensor};
import package::render::reference::sources::{
    ask_disc, ask_emitter, ask_light, ask_panorama, ask_peak, ask_peak_along, brightness,
    power_weight, NEVER,
};
import package::render::reference::surface::{meet, Met};
import package::render::reference::transmittance::{transmittance, MOST_LAYERS};
import package::render::reference::world::world;
import package::trace::coat::{below_coat, Coat};

// Sums over the samples of a pixel. A sensor uses `full`, `direct` (only of lights), `openness`,
// and `one_bounce` for a luminance.
struct Pixel {
    picture: vec3f,
    coverage: f32,
    direct: vec3f,
    depth_m: f32,
    one_bounce: vec3f,
    openness: f32,
    full: vec3f,
    padding_0: f32,
    albedo: vec3f,
    padding_1: f32,
    normal: vec3f,
    padding_2: f32,
}

@group(0) @binding(7) var<storage, read_write> film: array<Pixel>;

const MOST_VERTICES: u32 = 4096u;
// Paths with fewer vertices never end at random.
const SURE_VERTICES: u32 = 3u;
// Kinds of light queries; the last two are for peaks.
const KINDS: u32 = 4u + 2u * REFERENCE_HAS_PEAKS;
// The number of paths of a sample.
const PATHS: u32 = 2u - REFERENCE_HAS_SENSORS;

// Two sums: all light of a path, and the share that arrives early.
struct Light2 {
    all: vec3f,
    early: vec3f,
}

fn camera_ray(pixel: vec2u, jitter: vec2f) -> Ray {
    let place = (vec2f(pixel) + jitter) / vec2f(world.size) * 2.0 - 1.0;
    let along = world.forward + place.x * world.right - place.y * world.up;
    let direction = normalize(along);
    // The ray starts at the near plane, as in the rasterizer.
    return Ray(world.camera + world.near_m * along, direction, 3e38);
}

struct Traced {
    light: Light2,
    // The next four members describe the first vertex.
    is_surface: bool,
    albedo: vec3f,
    normal: vec3f,
    depth_m: f32,
    // Whether the second segment hit nothing within the reach of occlusion.
    is_open: bool,
}

fn trace(start: Ray, is_picture: bool) -> Traced {
    var traced: Traced;
    let is_sensor = REFERENCE_HAS_SENSORS != 0u && !is_picture;
    // The vertex whose light counts as early.
    let early_vertex = select(1u, 0u, is_picture || is_sensor);
    var ray = start;
    var throughput = vec3f(1.0);
    // Density with which the ray's direction was sampled.
    var density = 0.0;
    for (var vertex = 0u; vertex < MOST_VERTICES; vertex++) {
        // Find the surface that the ray hits, passing through see-through surfaces.
        var travelled = 0.0;
        var hit: Hit;
        var met: Met;
        let is_white_sensor = is_sensor && vertex == 0u;
        if is_white_sensor {
            hit.triangle = 0u;
            met.surface = white_sensor(start);
        }
        for (var layer = 0u; layer < MOST_LAYERS && !is_white_sensor; layer++) {
            hit = intersect(ray, select(BLOCKING, AS_SEEN, vertex == 0u), false);
            if hit.triangle == NO_TRIANGLE || hit.is_back {
                break;
            }
            met = meet(ray, hit, vertex == 0u);
            travelled += hit.distance;
            if REFERENCE_SEE_THROUGH == 0u || random() < met.coverage {
                break;
            }
            throughput *= met.tint;
            ray = ray_from(met.surface.position, -met.surface.geometric, ray.direction, 3e38);
        }
        let is_surface = hit.triangle != NO_TRIANGLE;
        if vertex == 1u {
            traced.is_open = !is_surface || travelled + hit.distance * f32(hit.is_back) > world.occlusion_distance_m;
        }
        if hit.is_back {
            // Backs of single-sided surfaces are black.
            break;
        }

        // The light at the ray's end, for gathers and for the camera. Only camera rays see peaks in
        // this way: for other rays peaks are lights, which next-event estimation samples.
        var shining = vec3f(0.0);
        var other = 0.0;
        if is_surface {
            shining = met.emission * below_coat(met.surface.coat, cos_toward(met.surface));
            let facing = abs(dot(met.surface.geometric, ray.direction));
            if REFERENCE_HAS_EMITTERS != 0u {
                other = f32(REFERENCE_CANDIDATES) * met.emitter_density * travelled * travelled / max(facing, 1e-8);
            }
        } else {
            let seen = surroundings(ray.direction);
            shining = seen.soft + select(vec3f(0.0), seen.peaks, vertex == 0u);
            if REFERENCE_HAS_PANORAMA != 0u {
                other = seen.density;
            }
        }
        // Only one technique samples the camera's ray.
        let weight = select(power_weight(density, other), 1.0, vertex == 0u);
        if is_picture || vertex > 0u {
            let arriving = throughput * weight * shining;
            traced.light.all += arriving;
            traced.light.early += select(vec3f(0.0), arriving, vertex == early_vertex);
        }
        if vertex == 0u {
            traced.is_surface = is_surface;
            if is_surface {
                traced.albedo = met.surface.diffuse;
                traced.normal = met.surface.shading;
                traced.depth_m = distance(met.surface.position, world.camera);
            }
        }
        if !is_surface {
            break;
        }
        var surface = met.surface;
        if vertex == 0u && !is_picture {
            surface.diffuse = vec3f(1.0);
            surface.f0 = vec3f(0.0);
            surface.phong_exponent = 0.0;
            surface.coat = Coat(0.0, 1.0);
        }
        // The last vertex only reflects direct light from lights, as a voxel does before any
        // bounce.
        let may_gather = vertex < world.most_bounces;

        let direction = draw_direction(surface);
        let scattered = scatter(surface, direction);
        let drawn_weight = select(
            vec3f(0.0), scattered.value / scattered.density, scattered.density > 0.0);
        for (var kind = 0u; kind < KINDS; kind++) {
            var question = NEVER;
            if kind == 0u && REFERENCE_HAS_LIGHTS != 0u {
                question = ask_light(surface);
            }
            if kind == 1u && REFERENCE_HAS_EMITTERS != 0u && may_gather {
                question = ask_emitter(surface);
            }
            if kind == 2u && REFERENCE_HAS_PANORAMA != 0u && may_gather {
                question = ask_panorama(surface);
            }
            if kind == 3u && REFERENCE_HAS_DISCS != 0u && any(drawn_weight > vec3f(0.0)) {
                question = ask_disc(surface, direction, drawn_weight, scattered.density);
            }
            if kind == 4u && REFERENCE_HAS_PANORAMA != 0u {
                question = ask_peak(surface);
            }
            if kind == 5u && any(drawn_weight > vec3f(0.0)) {
                question = ask_peak_along(direction, drawn_weight, scattered.density);
            }
            if !is_picture && vertex == 0u && !is_sensor {
                question.from_lights = vec3f(0.0);
            }
            let is_dark = all(question.from_lights + question.from_surroundings <= vec3f(0.0));
            if is_dark {
                continue;
            }
            let passing = throughput * transmittance(question, surface);
            let lights = passing * question.from_lights;
            let rest = passing * question.from_surroundings;
            traced.light.all += lights + rest;
            traced.light.early += select(vec3f(0.0), lights, vertex == early_vertex)
                + select(vec3f(0.0), rest, vertex == 0u && !is_picture && !is_sensor);
        }

        throughput *= drawn_weight;
        density = scattered.density;
        if all(throughput <= vec3f(0.0)) || !may_gather {
            break;
        }
        if vertex >= SURE_VERTICES {
            let survival = clamp(max(throughput.r, max(throughput.g, throughput.b)), 0.02, 0.98);
            if random() >= survival {
                break;
            }
            throughput /= survival;
        }
        ray = ray_from(surface.position, surface.geometric, direction, 3e38);
    }
    return traced;
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = vec2u(invocation.x, world.first_row + invocation.y);
    if invocation.y >= world.row_count || any(pixel >= world.size) {
        return;
    }
    let place = invocation.y * world.size.x + invocation.x;
    for (var index = 0u; index < world.sample_count; index++) {
        start_random(world.seed, pixel.y * world.size.x + pixel.x, world.first_sample + index);
        var start: Ray;
        var is_ray = false;
        if REFERENCE_HAS_SENSORS != 0u {
            let sensor = sensor_at(pixel);
            if !sensor.is_there {
                return;
            }
            start = sensor.ray;
            is_ray = sensor.is_ray;
        } else {
            start = camera_ray(pixel, random_2());
        }
        for (var which = 0u; which < PATHS; which++) {
            let is_picture = select(which == 0u, is_ray, REFERENCE_HAS_SENSORS != 0u);
            let traced = trace(start, is_picture);
            if REFERENCE_HAS_SENSORS != 0u {
                film[place].full += traced.light.all;
                film[place].direct += traced.light.early;
                film[place].one_bounce += vec3f(brightness(traced.light.all));
                film[place].openness += select(0.0, 1.0, traced.is_open);
            } else if is_picture {
                film[place].picture += traced.light.all;
                film[place].direct += traced.light.early;
                if traced.is_surface {
                    film[place].albedo += traced.albedo;
                    film[place].coverage += 1.0;
                    film[place].normal += traced.normal;
                    film[place].depth_m += traced.depth_m;
                }
            } else {
                film[place].full += traced.light.all;
                film[place].one_bounce += traced.light.early;
                film[place].openness += select(0.0, 1.0, traced.is_surface && traced.is_open);
            }
        }
    }
}
