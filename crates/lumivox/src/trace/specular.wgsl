// A glossy cone from each pixel of the glossy tiles (`glossy.wgsl`): reflected radiance in rgb, the
// pixel's samples (diffuse ones included) in a.
//
// Every turn draws half vectors from the distribution of visible normals, chooses one of them by
// its weight, F G2 / G1 (Heitz 2018, equation 19), and traces a cone along the mirrored direction.
// The mean over frames is the BRDF's integral, blurred only by the cone: its solid angle is share /
// pdf, a share of the solid angle per draw, the footprint of filtered importance sampling (Krivanek
// and Colbert 2008, section 4).
//
// A rough lobe uses known far light (known_gloss.wgsl), which near surfaces on its cones replace.
// Emitters are sampled separately (lobe_emitters.wgsl).
//
// Under a clear coat there are two lobes. A turn draws one of them, with a probability proportional
// to its reflectance, and divides by that probability.

import package::constants::LARGEST_HALF;
import package::gpu::random::{hash, random_pair, sequence_pair};
import package::environment::environment_reflection;
import package::trace::brdf::{alpha_from_roughness, fresnel_schlick, of_all_microfacets};
import package::trace::coat::{below_coat, coat_fresnel, coat_of, Coat};
import package::cascades::{drawn_level, finest_level};
import package::cones::cone::{Cone, START};
import package::cones::trace_method::{cone_growth, cone_start, trace_cone};
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::glossy::{place_in_tile, reflects, TILE};
import package::cones::hemisphere::basis;
import package::emitters::gather::{has_emitters, TURN_STEPS};
import package::trace::known_gloss::{resample, share_of_known};
import package::trace::lobe::Lobe;
import package::trace::lobe_emitters::{expected_irradiance, reflect_emitters};
import package::trace::surface::{Specular, Surface};
import package::trace::screen::{settings, traced_pixel, traced_size, traced_turn, TURNS_APART};
import package::trace::view::view;
import package::trace::gather_method::{find_known, known_from};
import package::trace::hit_method::light_of_hit;
import package::trace::reflections::{Shown, SHARP_ALPHA};
import package::volume::far_light::NEAR;

@group(1) @binding(1) var diffuse_samples: texture_2d<f32>;
@group(1) @binding(2) var specular_out: texture_storage_2d<rgba16float, write>;
// Distance of the reflected surface, in voxels; a texture of 1x1 if not needed.
@group(1) @binding(3) var distance_out: texture_storage_2d<r32float, write>;
// The number of glossy tiles, followed by their indices.
@group(1) @binding(4) var<storage, read> glossy_tiles: array<u32>;

// Cosine of 60 degrees, half of a hemisphere: wider cones would reach below their surface.
const MIN_COS_HALF_ANGLE: f32 = 0.5;

struct Reflection {
    // Radiance in rgb, samples in a.
    light: vec4f,
    // Distance of the reflected surface, in voxels; 0 if there is none.
    distance: f32,
}

// Values that all turns of a pixel share.
struct Gloss {
    surface: Surface,
    material: Specular,
    coat: Coat,
    world_from_normal: mat3x3f,
    cells_from_normal: mat3x3f,
    // The unit vector to the camera, in the frame whose z is the normal.
    view: vec3f,
    // The pixel's random numbers.
    start: vec2f,
    // The level of the surface's voxels.
    level: u32,
    // Approximate irradiance from all emitters.
    expected: f32,
}

// The mean of `turns` turns, starting at `turn`; `samples` is the number of samples of the pixel's
// diffuse cones.
fn trace_specular(pixel: vec2u, turn: u32, turns: u32, samples: f32) -> Reflection {
    var mean = Reflection(vec4f(0.0, 0.0, 0.0, samples), 0.0);
    let surface = load_surface(pixel);
    let material = load_specular(pixel);
    let coat = coat_of(material);
    if !reflects(surface, material) {
        return mean;
    }
    let world_from_normal = basis(surface.shading_normal);
    let to_camera = normalize(view.position_in_world - surface.position_in_world);
    var local_view = to_camera * world_from_normal;
    local_view.z = max(local_view.z, 1e-3);
    let start = random_pair(pixel.y + 0x9e3779b9u, hash(pixel.x));
    let level = drawn_level(surface.position_in_world, start.x);
    var expected = 0.0;
    if has_emitters() {
        expected = expected_irradiance(surface);
    }
    if share_of_known(max(alpha_from_roughness(material.roughness), coat.alpha)) > 0.0 {
        find_known(surface.position_in_world, surface.geometric_normal, level);
    }
    let gloss = Gloss(
        surface,
        material,
        coat,
        world_from_normal,
        transpose(basis(surface.geometric_normal)) * world_from_normal,
        normalize(local_view),
        start,
        level,
        expected,
    );
    for (var i = 0u; i < turns; i++) {
        let traced = trace_turn(gloss, turn + i * TURNS_APART);
        mean.light += vec4f(traced.light.rgb / f32(turns), traced.light.a);
        mean.distance += traced.distance / f32(turns);
    }
    // Near surfaces may replace more than all known light. A mirrored sun may exceed the largest
    // half float.
    mean.light = clamp(mean.light, vec4f(0.0), vec4f(LARGEST_HALF));
    return mean;
}

// The lobe of a turn.
fn choose_lobe(gloss: Gloss, turn: u32) -> Lobe {
    let below = below_coat(gloss.coat, gloss.view.z);
    let base_weight = below * dot(fresnel_schlick(gloss.material.reflectance, gloss.view.z), vec3f(1.0 / 3.0));
    let coat_weight = coat_fresnel(gloss.coat, gloss.view.z);
    // The golden ratio sequence is independent of the half vector's.
    let choice = fract(gloss.start.x - gloss.start.y + 1.0 + 0.618034 * f32(turn & 0xffffu));
    let coat_share = select(0.0, coat_weight / (coat_weight + base_weight), coat_weight > 0.0);
    let is_coat = choice < coat_share;
    let alpha = select(alpha_from_roughness(gloss.material.roughness), gloss.coat.alpha, is_coat);
    let factor = below * of_all_microfacets(gloss.material.reflectance, gloss.view.z, alpha);
    return Lobe(gloss.view, alpha, is_coat, gloss.material.reflectance, gloss.coat, factor, coat_share);
}

// Maximum number of mirrors that show each other.
const MOST_MIRRORS: u32 = 2u;

// The light along a cone of a lobe.
struct Met {
    radiance: vec3f,
    // The distance of the first surface, in voxels.
    distance: f32,
    samples: u32,
}

// Follows a cone, and further cones from the mirrors that it meets.
fn look(first: Cone, outside_width: f32, alpha: f32) -> Met {
    var met = Met(vec3f(0.0), 0.0, 0u);
    var cone = first;
    var share = vec3f(1.0);
    // Not a constant number: drivers would unroll the loop.
    var left = min(MOST_MIRRORS, settings.turns + 1u);
    var is_first = true;
    loop {
        let traced = trace_cone(cone, settings.cones);
        let place = cone.origin_in_grid + cone.direction * traced.distance;
        var shown = Shown(traced.radiance, vec3f(0.0), vec3f(0.0));
        if alpha < SHARP_ALPHA {
            shown = light_of_hit(traced, place, cone.direction, left > 1u);
        }
        let outside = environment_reflection(cone.direction, outside_width, alpha);
        // A mirror uses a single ray, so negative values do not average out, but no pixel may be
        // negative.
        var radiance = max(shown.radiance + traced.transmittance * outside, vec3f(0.0));
        // Emitters are sampled separately, but not through a second mirror.
        if !is_first || !has_emitters() {
            radiance += traced.emission;
        }
        met.radiance += share * radiance;
        met.distance = select(met.distance, traced.distance, is_first);
        met.samples += traced.samples;
        share *= shown.mirrored;
        cone.direction = reflect(cone.direction, shown.normal);
        cone.level = finest_level(place, cone.level, 0.0);
        cone.origin_in_grid = place + shown.normal * (START * exp2(f32(cone.level)));
        is_first = false;
        left -= 1u;
        continuing {
            break if left == 0u || all(share <= vec3f(0.0));
        }
    }
    return met;
}

// `turn` is the index in the jitter sequence.
fn trace_turn(gloss: Gloss, turn: u32) -> Reflection {
    let surface = gloss.surface;
    let start = gloss.start;
    let level = gloss.level;
    let lobe = choose_lobe(gloss, turn);
    let known_share = share_of_known(lobe.alpha);
    let lot = fract(4096.0 * start.x + 0.414214 * f32(turn & 0xffffu));
    let resampled = resample(
        lobe, gloss.cells_from_normal, vec3f(sequence_pair(start, turn), lot), known_share > 0.0);
    var reflected = known_share * resampled.known;
    var samples = 0.0;
    if has_emitters() {
        let numbers = fract(start.yx + fract(TURN_STEPS * f32(turn & 0xffffu)));
        let from_emitters = reflect_emitters(
            surface, lobe, gloss.world_from_normal, level, gloss.expected, sequence_pair(start, turn), numbers);
        reflected += from_emitters.rgb;
        samples = from_emitters.a;
    }
    let drawn = resampled.drawn;
    let direction = gloss.world_from_normal * drawn.direction;
    let cos_plane = dot(direction, surface.geometric_normal);
    if drawn.direction.z <= 0.0 || cos_plane <= 0.0 {
        return Reflection(vec4f(reflected, samples), 0.0);
    }

    let cos_half = max(1.0 - settings.specular_share / drawn.density / 6.28318530718, MIN_COS_HALF_ANGLE);
    let tan_half = sqrt(1.0 - cos_half * cos_half) / cos_half;
    let origin = cone_start(
        surface.position_in_world, surface.geometric_normal, level, settings.cones);
    let growth = cone_growth(tan_half, cos_plane, settings.cones);
    let level_offset = fract(start.x + start.y + 0.754878 * f32(turn & 0xffffu));
    // A mirror shows the environment sharply, whatever the width of its cone.
    let outside_width = min(growth, 2.0 * tan_half * settings.cones.voxel_per_diameter);
    let met = look(Cone(origin, direction, growth, 3e38, level_offset, level), outside_width, lobe.alpha);
    samples += f32(met.samples);
    var radiance = met.radiance;
    // Near surfaces replace the known light in their direction.
    let known = known_from(gloss.cells_from_normal * drawn.direction);
    let its = select(0.0, known_share, known.is_known);
    let is_near = met.distance < NEAR * exp2(f32(level));
    radiance = select(radiance * (1.0 - its), radiance - known.radiance * its, is_near);
    return Reflection(vec4f(reflected + radiance * drawn.weight, samples), met.distance);
}

@compute @workgroup_size(TILE, TILE)
fn main(
    @builtin(local_invocation_id) local: vec3u,
    @builtin(workgroup_id) workgroup: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = workgroup.y * workgroups.x + workgroup.x;
    if index >= glossy_tiles[0] {
        return;
    }
    let place = place_in_tile(glossy_tiles[1u + index], local.xy);
    if any(place >= traced_size()) {
        return;
    }
    let samples = textureLoad(diffuse_samples, place, 0).r;
    let traced = trace_specular(traced_pixel(place), traced_turn(), settings.turns, samples);
    textureStore(specular_out, place, traced.light);
    textureStore(distance_out, place, vec4f(traced.distance, 0.0, 0.0, 0.0));
}
