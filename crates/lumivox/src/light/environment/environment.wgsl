// What a cone sees that leaves the grid: the surroundings at the resolution of its last cells.
//
// A cone reads cells of an edge that grows with the distance, growth * t; seen from its start they all have the
// angle `growth`. It reads the mip at which a bilinear sample is as wide. Mips hold means over solid angles, in
// multiples of `light_globals.environment`.
//
// Where there is no map nothing is read: SwiftShader, the software GPU of browsers, reads beyond a cube's edges what
// was in its memory before, and black times that may be no number.

import package::constants::LIGHT_ENVIRONMENT;
import package::light::lights::{light_globals, Light};

// All of the surroundings.
@group(2) @binding(5) var environment_sharp: texture_cube<f32>;
// Without the peaks that are lights (LIGHT_ENVIRONMENT).
@group(2) @binding(6) var environment_soft: texture_cube<f32>;
@group(2) @binding(7) var environment_sampler: sampler;

// The width of a bilinear sample, in texels: of the box with the same noise, 1 over the integral of the squared
// tent.
const TEXELS_PER_SAMPLE: f32 = 1.5;

// From the world to the map: a turn about y.
fn map_from_world(direction: vec3f) -> vec3f {
    let turn = light_globals.environment_turn;
    return vec3f(
        turn.x * direction.x - turn.y * direction.z,
        direction.y,
        turn.y * direction.x + turn.x * direction.z,
    );
}

// The level of a cube of `edge` texels at which a sample around a unit vector is `width` radians wide. A face
// spans 2 at a distance of 1; a texel in the direction d has the solid angle (2 / edge)^2 (d . axis)^3.
fn cube_level(direction: vec3f, width: f32, edge: u32) -> f32 {
    let size = abs(direction);
    let along_axis = max(size.x, max(size.y, size.z));
    let texel = 2.0 / f32(edge) * along_axis * sqrt(along_axis);
    return max(log2(max(width, 1e-6) / (TEXELS_PER_SAMPLE * texel)), 0.0);
}

// Radiance from outside along a unit vector, for cells of an edge of `width` times the distance; without the
// peaks that are lights.
fn environment_radiance(direction: vec3f, width: f32) -> vec3f {
    if light_globals.has_map == 0u {
        return light_globals.environment;
    }
    let in_map = map_from_world(direction);
    let level = cube_level(in_map, width, textureDimensions(environment_soft).x);
    return light_globals.environment
        * textureSampleLevel(environment_soft, environment_sampler, in_map, level).rgb;
}

// The same along a glossy reflection. A lobe (alpha of the microfacets) narrower than the peaks shows them as
// they are; a wider one gets them from their lights, see `glossy_share`.
fn environment_reflection(direction: vec3f, width: f32, alpha: f32) -> vec3f {
    if alpha >= light_globals.mirror_alpha || light_globals.has_map == 0u {
        return environment_radiance(direction, width);
    }
    let in_map = map_from_world(direction);
    let level = cube_level(in_map, width, textureDimensions(environment_sharp).x);
    return light_globals.environment
        * textureSampleLevel(environment_sharp, environment_sampler, in_map, level).rgb;
}

// The share of a light that its highlight shows: none where `environment_reflection` does already.
fn glossy_share(light: Light, alpha: f32) -> f32 {
    return select(
        1.0, 0.0, light.kind == LIGHT_ENVIRONMENT && alpha < light_globals.mirror_alpha);
}

// What the eye sees along a unit vector: all of it, sharp.
fn environment_background(direction: vec3f) -> vec3f {
    if light_globals.has_map == 0u {
        return light_globals.environment;
    }
    return light_globals.environment
        * textureSampleLevel(environment_sharp, environment_sampler, map_from_world(direction), 0.0)
            .rgb;
}
