// A glossy cone from each pixel: reflected radiance in rgb, the pixel's samples (diffuse ones
// included) in a.
//
// Every frame draws one half vector from the distribution of visible normals and traces a cone
// along the mirrored direction. The cone's solid angle is share / pdf, a share of what the draw
// represents: the footprint of filtered importance sampling (Krivanek and Colbert 2008, section 4).
// The weight of the draw is F G2 / G1 (Heitz 2018, equation 19), so the mean over frames is the
// BRDF's integral, blurred only by the cone.
//
// Under a clear coat there are two lobes. A frame draws one of them, with a probability
// proportional to its reflectance, and divides by that probability.
//
// Emitters are sampled as well, since a wide lobe rarely finds a small one. The two ways of
// sampling are combined by the squares of both densities (the power heuristic: Veach and Guibas
// 1995, "Optimally combining sampling techniques for Monte Carlo rendering").

import package::gpu::random::{hash, random_pair, sequence_pair};
import package::environment::environment_reflection;
import package::trace::brdf::{
    alpha_from_roughness, fresnel_schlick, ggx_distribution, ggx_masking, ggx_visibility, mirrored_density,
    sample_visible_normal,
};
import package::trace::coat::{below_coat, coat_fresnel, coat_of, Coat};
import package::cascades::drawn_level;
import package::cones::cone::Cone;
import package::cones::way::{cone_growth, cone_start, trace_cone};
import package::trace::gbuffer::{load_specular, load_surface};
import package::cones::hemisphere::basis;
import package::cones::model::glossy_half_vector;
import package::emitters::draw::{
    draw_emitter, emitters, point_of, EmitterPoint,
};
import package::emitters::emitter::strength;
import package::emitters::gather::{candidate, trace_to, STEPS};
import package::grid::grid_from_world;
import package::trace::surface::Surface;
import package::trace::screen::{settings, traced_pixel, traced_size, traced_turn, TURNS_APART};
import package::trace::view::view;

@group(1) @binding(1) var diffuse_samples: texture_2d<f32>;
@group(1) @binding(2) var specular_out: texture_storage_2d<rgba16float, write>;
// Distance to what is reflected, in voxels. It is 1x1 if it is not needed.
@group(1) @binding(3) var distance_out: texture_storage_2d<r32float, write>;

// Number of emitter points from which the lobe's point is drawn, and number of points for the
// expected irradiance.
const REFLECTED: u32 = 4u;
const EXPECTING: u32 = 2u;

// Cosine of 60 degrees, half of a hemisphere: wider cones would reach below the surface that they
// leave.
const MIN_COS_HALF_ANGLE: f32 = 0.5;

struct Reflection {
    // Radiance in rgb, samples in a.
    light: vec4f,
    // In voxels; 0 if nothing is reflected.
    distance: f32,
}

// The mean of `turns` turns, starting at `turn`; `samples` is the number of samples of the pixel's
// diffuse cones.
fn trace_specular(pixel: vec2u, turn: u32, turns: u32, samples: f32) -> Reflection {
    var mean = Reflection(vec4f(0.0, 0.0, 0.0, samples), 0.0);
    for (var i = 0u; i < turns; i++) {
        let traced = trace_turn(pixel, turn + i * TURNS_APART);
        mean.light += vec4f(traced.light.rgb / f32(turns), traced.light.a);
        mean.distance += traced.distance / f32(turns);
    }
    return mean;
}

// The lobe drawn by a frame.
struct Lobe {
    // The unit vector to the camera, in the frame whose z is the normal.
    view: vec3f,
    alpha: f32,
    is_coat: bool,
    reflectance: vec3f,
    coat: Coat,
    // The share of light from below that the coat transmits, and the probability of drawing the
    // coat.
    below: f32,
    coat_share: f32,
}

fn fresnel_of(lobe: Lobe, cosine: f32) -> vec3f {
    if lobe.is_coat {
        return vec3f(coat_fresnel(lobe.coat, cosine) / lobe.coat_share);
    }
    return fresnel_schlick(lobe.reflectance, cosine) * (lobe.below / (1.0 - lobe.coat_share));
}

// Weight of lobe sampling for the light of a direction: `density` is the lobe's density, `emitted`
// approximately that of the emitters, both in 1/sr.
fn share_of_lobe(density: f32, emitted: f32) -> f32 {
    return density * density / max(density * density + emitted * emitted, 1e-30);
}

// The light of a point on an emitter that the lobe reflects to the camera, without occlusion, times
// the point's solid angle and the weight of emitter sampling. `expected` is approximately the
// irradiance from all emitters.
fn reflected_from(point: EmitterPoint, lobe: Lobe, normal_from_world: mat3x3f, geometric_normal: vec3f, expected: f32) -> vec3f {
    let light = normal_from_world * point.direction;
    if light.z <= 0.0 || dot(point.direction, geometric_normal) <= 0.0 || point.solid_angle <= 0.0 {
        return vec3f(0.0);
    }
    let half_vector = normalize(light + lobe.view);
    let brdf = fresnel_of(lobe, dot(lobe.view, half_vector))
        * (ggx_distribution(half_vector.z, lobe.alpha) * ggx_visibility(lobe.view.z, light.z, lobe.alpha));
    let density = mirrored_density(lobe.view.z, half_vector.z, lobe.alpha);
    let share = share_of_lobe(density, strength(point.radiance) * light.z / expected);
    return point.radiance * brdf * (light.z * point.solid_angle * (1.0 - share));
}

// Approximate irradiance from all emitters, without occlusion. It is deterministic for a place, so
// that both ways of sampling use the same weights.
fn expected_irradiance(surface: Surface) -> f32 {
    let place = grid_from_world(surface.position_in_world);
    var sum = 0.0;
    for (var i = 0u; i < EXPECTING; i++) {
        let point = point_of(draw_emitter(place, surface.geometric_normal, candidate(vec2f(0.5), i, EXPECTING)), place);
        sum += strength(point.radiance) * max(dot(point.direction, surface.geometric_normal), 0.0) * point.solid_angle;
    }
    return max(sum / f32(EXPECTING), 1e-20);
}

// Reflected light of sampled emitters, times the weight of emitter sampling: one of several points
// is kept, as in emitters/gather.wgsl. In a the samples of its ray.
fn reflect_emitters(
    surface: Surface,
    lobe: Lobe,
    normal_from_world: mat3x3f,
    level: u32,
    expected: f32,
    numbers: vec2f,
) -> vec4f {
    let place = grid_from_world(surface.position_in_world);
    var kept: EmitterPoint;
    var sum = 0.0;
    // A random number, rescaled to [0, 1) after each choice.
    var lot = fract(numbers.x * 4096.0);
    for (var i = 0u; i < REFLECTED; i++) {
        let point = point_of(draw_emitter(place, surface.geometric_normal, candidate(numbers, i, REFLECTED)), place);
        let brings = strength(reflected_from(point, lobe, normal_from_world, surface.geometric_normal, expected));
        sum += brings;
        let share = brings / max(sum, 1e-30);
        if brings > 0.0 && lot < share {
            kept = point;
            lot /= share;
        } else {
            lot = (lot - share) / max(1.0 - share, 1e-6);
        }
    }
    if sum <= 0.0 {
        return vec4f(0.0);
    }
    let traced = trace_to(kept, surface.position_in_world, surface.geometric_normal, level, settings.cones);
    let its = reflected_from(kept, lobe, normal_from_world, surface.geometric_normal, expected);
    let seen = traced.transmittance * sum / f32(REFLECTED);
    return vec4f(its * (seen / max(strength(its), 1e-30)), f32(traced.samples));
}

// `turn` is the index in the jitter sequence.
fn trace_turn(pixel: vec2u, turn: u32) -> Reflection {
    let nothing = Reflection(vec4f(0.0), 0.0);
    let surface = load_surface(pixel);
    let material = load_specular(pixel);
    let is_off = settings.bounces == 0u || settings.specular_share <= 0.0;
    let coat = coat_of(material);
    if surface.depth <= 0.0 || is_off || (all(material.reflectance <= vec3f(0.0)) && coat.strength <= 0.0) {
        return nothing;
    }

    let world_from_normal = basis(surface.shading_normal);
    let to_camera = normalize(view.position_in_world - surface.position_in_world);
    var local_view = to_camera * world_from_normal;
    local_view.z = max(local_view.z, 1e-3);
    local_view = normalize(local_view);

    let start = random_pair(pixel.y + 0x9e3779b9u, hash(pixel.x));
    let below = below_coat(coat, local_view.z);
    let base_weight = below * dot(fresnel_schlick(material.reflectance, local_view.z), vec3f(1.0 / 3.0));
    let coat_weight = coat_fresnel(coat, local_view.z);
    // The golden ratio sequence is independent of the half vector's.
    let choice = fract(start.x - start.y + 1.0 + 0.618034 * f32(turn & 0xffffu));
    let coat_share = select(0.0, coat_weight / (coat_weight + base_weight), coat_weight > 0.0);
    let is_coat = choice < coat_share;
    let alpha = select(alpha_from_roughness(material.roughness), coat.alpha, is_coat);
    let drawn = sample_visible_normal(local_view, alpha, sequence_pair(start, turn));
    let half_vector = glossy_half_vector(drawn, settings.cones.model_values);
    let local_light = reflect(-local_view, half_vector);
    let direction = world_from_normal * local_light;
    let cos_plane = dot(direction, surface.geometric_normal);
    if local_light.z <= 0.0 || cos_plane <= 0.0 {
        return nothing;
    }

    let solid_angle = settings.specular_share / mirrored_density(local_view.z, half_vector.z, alpha);
    let cos_half = max(1.0 - solid_angle / 6.28318530718, MIN_COS_HALF_ANGLE);
    let tan_half = sqrt(1.0 - cos_half * cos_half) / cos_half;

    let level = drawn_level(surface.position_in_world, start.x);
    let origin = cone_start(
        surface.position_in_world, surface.geometric_normal, level, settings.cones);
    let growth = cone_growth(tan_half, cos_plane, settings.cones);
    let level_offset = fract(start.x + start.y + 0.754878 * f32(turn & 0xffffu));
    let traced = trace_cone(Cone(origin, direction, growth, 3e38, level_offset, level), settings.cones);
    // A mirror shows the environment sharply, whatever the width of its cone.
    let outside_width = min(growth, 2.0 * tan_half * settings.cones.voxel_per_diameter);
    let outside = environment_reflection(direction, outside_width, alpha);
    // A mirror uses a single ray, so negative values are not averaged out: no pixel may be darker
    // than black.
    var radiance = max(traced.radiance + traced.transmittance * outside, vec3f(0.0));

    let lobe = Lobe(local_view, alpha, is_coat, material.reflectance, coat, below, coat_share);
    var from_emitters = vec4f(0.0);
    if emitters.count > 0u && emitters.is_shown == 0u {
        let expected = expected_irradiance(surface);
        let numbers = fract(start.yx + fract(STEPS * f32(turn & 0xffffu)));
        from_emitters = reflect_emitters(surface, lobe, transpose(world_from_normal), level, expected, numbers);
        let density = mirrored_density(local_view.z, half_vector.z, alpha);
        let share = share_of_lobe(density, strength(traced.emission) * local_light.z / expected);
        radiance = max(radiance - (1.0 - share) * traced.emission, vec3f(0.0));
    }

    let fresnel = fresnel_of(lobe, dot(local_view, half_vector));
    let both = ggx_visibility(local_view.z, local_light.z, alpha) * 4.0 * local_view.z
        * local_light.z;
    let weight = fresnel * (both / ggx_masking(local_view.z, alpha));
    // A mirror of the sun may exceed the largest half float.
    let reflected = min(radiance * weight + from_emitters.rgb, vec3f(65504.0));
    return Reflection(vec4f(reflected, f32(traced.samples) + from_emitters.a), traced.distance);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    if any(invocation.xy >= traced_size()) {
        return;
    }
    let samples = textureLoad(diffuse_samples, invocation.xy, 0).r;
    let traced = trace_specular(traced_pixel(invocation.xy), traced_turn(), settings.turns, samples);
    textureStore(specular_out, invocation.xy, traced.light);
    textureStore(distance_out, invocation.xy, vec4f(traced.distance, 0.0, 0.0, 0.0));
}
