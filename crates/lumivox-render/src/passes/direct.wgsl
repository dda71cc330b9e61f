// Direct light on the visible surfaces from lamps and sun.

import package::constants::{LARGEST_HALF, PI};
import package::environment::glossy_share;
import package::light::lights::{incident_light, is_parallel, Light, light_globals, lights};
import package::light::shadow_map::{
    compare_depths, finest_layer, is_within, place_in_layer, shadow_layers, shadow_sampler,
};
import package::light::visibility::light_visibility;
import package::trace::brdf::{
    alpha_from_roughness, fresnel_schlick, ggx_distribution, ggx_visibility, of_all_microfacets,
};
import package::trace::coat::{below_coat, coat_fresnel, load_coat};
import package::trace::gbuffer::{gbuffer_diffuse, gbuffer_specular, load_surface};
import package::trace::view::view;

// Reflected radiance in rgb, visibility in a.
@group(1) @binding(0) var direct_diffuse: texture_storage_2d<rgba16float, write>;
// Reflected radiance in rgb, illuminance in a.
@group(1) @binding(1) var direct_specular: texture_storage_2d<rgba32float, write>;

// A square layer of a parallel light's shadow map around the camera.
struct NearLayer {
    clip_from_world: mat4x4f,
    // Edge of a texel in the world, m.
    texel_size: f32,
    // The index of its light in `lights`.
    light: u32,
    padding_0: u32,
    padding_1: u32,
}

// Ordered by light, and for each light from the smallest square to the largest.
@group(1) @binding(2) var<storage, read> near_layers: array<NearLayer>;
@group(1) @binding(3) var near_maps: texture_depth_2d_array;

// Highlights smaller than a pixel are widened by the variation of the normal within it, so that
// samples do not miss them (Tokuyoshi and Kaplanyan 2019, "Improved geometric specular
// antialiasing", listing 1): twice the variance of the pixel's filter, and the maximum added to
// alpha^2.
const FILTER: f32 = 0.3183099;
const MOST_ADDED: f32 = 0.18;

const NO_NEIGHBOUR: f32 = 1e9;

// The squared difference to the normal of another pixel.
fn normal_difference(pixel: vec2u, step: vec2i, normal: vec3f) -> f32 {
    let other = load_surface(vec2u(clamp(vec2i(pixel) + step, vec2i(0), vec2i(view.size) - 1)));
    let difference = other.shading_normal - normal;
    return select(NO_NEIGHBOUR, dot(difference, difference), other.depth > 0.0);
}

// The variance added to alpha^2. On each axis the more similar neighbour counts: the other may be
// on another surface. Later frames of a mean add less, since earlier frames have samples in
// between.
fn added_variance(pixel: vec2u, normal: vec3f) -> f32 {
    var sum = 0.0;
    for (var axis = 0; axis < 2; axis++) {
        let step = vec2i(1 - axis, axis);
        let least = min(normal_difference(pixel, step, normal), normal_difference(pixel, -step, normal));
        sum += select(0.0, least, least < NO_NEIGHBOUR);
    }
    return min(FILTER * sum, MOST_ADDED) / f32(view.frame + 1u);
}

fn luminance(color: vec3f) -> f32 {
    // ITU-R BT.709-6, section 3.2.
    return dot(color, vec3f(0.2126, 0.7152, 0.0722));
}

// The visible share of a light at a point, from the smallest of the light's squares that contains
// the point; -1 if there is none, or none is finer than the light's map for the voxels. `next` is
// the index of the next layer to test; it is advanced past the light's own layers.
fn near_visibility(next: ptr<function, u32>, index: u32, position_in_world: vec3f, normal: vec3f) -> f32 {
    var found = -1.0;
    while *next < arrayLength(&near_layers) && near_layers[*next].light <= index {
        let near = near_layers[*next];
        let place = place_in_layer(near.clip_from_world, near.texel_size, position_in_world, normal);
        if found < 0.0 && near.light == index && is_within(place, near_maps) {
            let layer = finest_layer(lights[index].shadow_layer, position_in_world, normal);
            if near.texel_size < shadow_layers[layer].texel_size {
                found = compare_depths(near_maps, shadow_sampler, *next, place);
            }
        }
        *next += 1u;
    }
    return found;
}

// The variance added to alpha^2 for the disc of a light: twice the variance of the half vector on
// an axis. The half vector turns by half the angle, and the variance of a disc on an axis is a
// quarter of its radius squared.
fn disc_variance(light: Light, distance_m: f32) -> f32 {
    let radius = select(light.radius / distance_m, light.radius, is_parallel(light));
    return radius * radius / 8.0;
}

fn widened(alpha: f32, added: f32) -> f32 {
    return sqrt(saturate(alpha * alpha + added));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    if surface.depth == 0.0 {
        textureStore(direct_diffuse, pixel, vec4f(0.0, 0.0, 0.0, 1.0));
        textureStore(direct_specular, pixel, vec4f(0.0));
        return;
    }
    let albedo = textureLoad(gbuffer_diffuse, pixel, 0).rgb;
    let specular = textureLoad(gbuffer_specular, pixel, 0);
    let normal = surface.shading_normal;
    let coat = load_coat(pixel);
    let added = added_variance(pixel, normal);
    let lobe_alpha = alpha_from_roughness(specular.a);
    let to_camera = normalize(view.position_in_world - surface.position_in_world);
    // Avoids grazing angles: the visibility term is 0 / 0 there.
    let n_dot_v = max(dot(normal, to_camera), 1e-4);

    var diffuse = vec3f(0.0);
    var glossy = vec3f(0.0);
    var varnish = vec3f(0.0);
    var illuminance = 0.0;
    var arriving = 0.0;
    var sent = 0.0;
    var next_near = 0u;
    for (var index = 0u; index < light_globals.light_count; index++) {
        let light = lights[index];
        let incident = incident_light(light, surface.position_in_world);
        let brightness = luminance(incident.irradiance);
        sent += brightness;
        let n_dot_l = dot(normal, incident.direction);
        // The geometric normal is tested as well: a bent normal must not receive light from behind
        // the surface.
        if brightness <= 0.0 || n_dot_l <= 0.0
            || dot(surface.geometric_normal, incident.direction) <= 0.0 {
            continue;
        }
        let plane = surface.geometric_normal;
        var visible = near_visibility(&next_near, index, surface.position_in_world, plane);
        if visible < 0.0 {
            visible = light_visibility(light, incident, surface.position_in_world, plane);
        }
        arriving += visible * brightness;
        let irradiance = visible * n_dot_l * incident.irradiance;
        illuminance += luminance(irradiance);
        let half_vector = normalize(incident.direction + to_camera);
        let fresnel = fresnel_schlick(specular.rgb, dot(half_vector, to_camera));
        // Light that the gloss reflects does not reach the diffuse layer: glTF 2.0, appendix B.3.
        diffuse += irradiance * (1.0 - fresnel) * albedo / PI;
        let widening = added + disc_variance(light, incident.distance_m);
        let alpha = widened(lobe_alpha, widening);
        let varnish_alpha = widened(coat.alpha, widening);
        glossy += glossy_share(light, lobe_alpha) * irradiance * fresnel
            * ggx_distribution(saturate(dot(normal, half_vector)), alpha)
            * ggx_visibility(n_dot_v, n_dot_l, alpha);
        varnish += glossy_share(light, coat.alpha) * irradiance * coat_fresnel(coat, dot(half_vector, to_camera))
            * ggx_distribution(saturate(dot(normal, half_vector)), varnish_alpha)
            * ggx_visibility(n_dot_v, n_dot_l, varnish_alpha);
    }
    let below = below_coat(coat, n_dot_v);
    diffuse *= below;
    glossy = below * of_all_microfacets(specular.rgb, n_dot_v, lobe_alpha) * glossy + varnish;
    let visibility = select(1.0, arriving / sent, sent > 0.0);
    textureStore(direct_diffuse, pixel, vec4f(min(diffuse, vec3f(LARGEST_HALF)), visibility));
    textureStore(direct_specular, pixel, vec4f(glossy, illuminance));
}
