// The radiance that a cone sees outside the grid: the environment, at its own resolution.
//
// A sample subtends the angle `growth` at the cone's start. It reads the mip in which a bilinear
// sample is equally wide. Mips store means over solid angles, in multiples of
// `light_globals.environment`.
//
// The cube is laid out in a 2D texture (atlas.rs): every face of every mip has a border with the
// texels beyond its edges. Samplers would filter a cube texture across edges, but SwiftShader, the
// software GPU of browsers, reads uninitialized memory there.

import package::constants::LIGHT_ENVIRONMENT;
import package::light::lights::{light_globals, Light};

// The whole environment.
@group(2) @binding(5) var environment_sharp: texture_2d<f32>;
// The environment without the peaks that became lights (LIGHT_ENVIRONMENT).
@group(2) @binding(6) var environment_soft: texture_2d<f32>;
@group(2) @binding(7) var environment_sampler: sampler;

// The width of a bilinear sample, in texels: the width of a box filter with the same noise, 1 /
// (integral of the squared tent).
const TEXELS_PER_SAMPLE: f32 = 1.5;

// Rotates a direction in the world to the map, about y.
fn map_from_world(direction: vec3f) -> vec3f {
    let turn = light_globals.environment_turn;
    return vec3f(
        turn.x * direction.x - turn.y * direction.z,
        direction.y,
        turn.y * direction.x + turn.x * direction.z,
    );
}

// The level of a cube of `edge` texels at which a sample around a unit vector is `width` radians
// wide. A face spans 2 at a distance of 1; a texel in the direction d has the solid angle (2 /
// edge)^2 (d . axis)^3.
fn cube_level(direction: vec3f, width: f32, edge: u32) -> f32 {
    let size = abs(direction);
    let along_axis = max(size.x, max(size.y, size.z));
    let texel = 2.0 / f32(edge) * along_axis * sqrt(along_axis);
    return max(log2(max(width, 1e-6) / (TEXELS_PER_SAMPLE * texel)), 0.0);
}

// The edge of a face of the first mip of a map of this size: see Layout in atlas.rs.
fn cube_edge(size: vec2u) -> u32 {
    return (2u * size.x - 24u) / 9u;
}

// The point at which a direction meets the cube: the number of the face, and the position on it, 0
// to 1 from its left and top edge.
struct CubePlace {
    face: u32,
    place: vec2f,
}

// Vulkan 1.3, section "Cube map face selection". Without branches, since lavapipe crashes if it
// inlines uniforms that conditions depend on.
fn cube_place(direction: vec3f) -> CubePlace {
    let size = abs(direction);
    let is_x = (size.x >= size.y) & (size.x >= size.z);
    let is_y = !is_x & (size.y >= size.z);
    let sign_x = select(1.0, -1.0, direction.x < 0.0);
    let sign_y = select(1.0, -1.0, direction.y < 0.0);
    let sign_z = select(1.0, -1.0, direction.z < 0.0);
    let on_z = vec4f(sign_z * direction.x, -direction.y, size.z, 4.5 - 0.5 * sign_z);
    let on_y = vec4f(direction.x, sign_y * direction.z, size.y, 2.5 - 0.5 * sign_y);
    let on_x = vec4f(-sign_x * direction.z, -direction.y, size.x, 0.5 - 0.5 * sign_x);
    let on = select(select(on_z, on_y, is_y), on_x, is_x);
    return CubePlace(u32(on.w), 0.5 + 0.5 * on.xy / on.z);
}

// A bilinear sample of one mip.
fn sample_mip(map: texture_2d<f32>, at: CubePlace, mip: u32) -> vec3f {
    let size = textureDimensions(map);
    let first = cube_edge(size);
    let edge = first >> mip;
    // The first mip is at the left; the others are in a column to its right.
    let above = select(0u, 2u * (first - 2u * edge) + 4u * (mip - 1u), mip > 0u);
    let corner = vec2u(select(0u, 3u * (first + 2u), mip > 0u), above)
        + vec2u(at.face % 3u, at.face / 3u) * (edge + 2u);
    let place = vec2f(corner) + 1.0 + at.place * f32(edge);
    return textureSampleLevel(map, environment_sampler, place / vec2f(size), 0.0).rgb;
}

// Trilinear sample in the direction of a unit vector.
fn sample_cube(map: texture_2d<f32>, direction: vec3f, level: f32) -> vec3f {
    let last = firstLeadingBit(cube_edge(textureDimensions(map)));
    let mip = min(u32(level), last);
    let at = cube_place(direction);
    return mix(
        sample_mip(map, at, mip),
        sample_mip(map, at, min(mip + 1u, last)),
        saturate(level - f32(mip)),
    );
}

// Radiance from outside along a unit vector, without the peaks that became lights; `width` is the
// edge of the cells divided by the distance.
fn environment_radiance(direction: vec3f, width: f32) -> vec3f {
    let in_map = map_from_world(direction);
    let level = cube_level(in_map, width, cube_edge(textureDimensions(environment_soft)));
    return light_globals.environment * sample_cube(environment_soft, in_map, level);
}

// Radiance from outside along a glossy reflection. A lobe (alpha of the microfacets) narrower than
// the peaks reflects them in the map; a wider one reflects their lights, see `glossy_share`.
fn environment_reflection(direction: vec3f, width: f32, alpha: f32) -> vec3f {
    if alpha >= light_globals.mirror_alpha {
        return environment_radiance(direction, width);
    }
    let in_map = map_from_world(direction);
    let level = cube_level(in_map, width, cube_edge(textureDimensions(environment_sharp)));
    return light_globals.environment * sample_cube(environment_sharp, in_map, level);
}

// The share of a light in its highlight: 0 if `environment_reflection` already shows the light.
fn glossy_share(light: Light, alpha: f32) -> f32 {
    return select(
        1.0, 0.0, light.kind == LIGHT_ENVIRONMENT && alpha < light_globals.mirror_alpha);
}

// The background's radiance along a unit vector: the whole environment, sharp.
fn environment_background(direction: vec3f) -> vec3f {
    return light_globals.environment
        * sample_mip(environment_sharp, cube_place(map_from_world(direction)), 0u);
}
