// Converts a cube texture to the flat map that cones read: means over the texels of its first mip,
// the other mips, and all of them laid out with their borders. `cube.rs` and `atlas.rs` do the same
// on the CPU.

import package::constants::LARGEST_HALF;
import package::environment::cube_place;

struct CubeLight {
    // Transform from the world to the cube texture; fourth components of columns are not read.
    cube_from_world: mat3x3f,
    added: vec3f,
    factor: f32,
    // Samples along an edge of a texel.
    samples: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
}

struct CubeLevel {
    // Texels along an edge of a face.
    edge: u32,
    // First texel of this level in `levels`, and that of the finer level.
    first: u32,
    finer: u32,
    padding_0: u32,
    // The corner of this level's first face in the map.
    corner: vec2u,
    padding: vec2u,
}

@group(1) @binding(0) var<uniform> cube_light: CubeLight;
@group(1) @binding(1) var cube: texture_cube<f32>;
@group(1) @binding(2) var cube_sampler: sampler;

@group(0) @binding(0) var<uniform> level: CubeLevel;
// The texels of all levels, face by face, in rows.
@group(0) @binding(1) var<storage, read_write> levels: array<vec4f>;
@group(0) @binding(2) var map: texture_storage_2d<rgba16float, write>;

// The direction of a position on a face, -1 to 1 along both edges.
fn direction_on(face: u32, place: vec2f) -> vec3f {
    switch face {
        case 0u: { return vec3f(1.0, -place.y, -place.x); }
        case 1u: { return vec3f(-1.0, -place.y, place.x); }
        case 2u: { return vec3f(place.x, 1.0, place.y); }
        case 3u: { return vec3f(place.x, -1.0, -place.y); }
        case 4u: { return vec3f(place.x, -place.y, 1.0); }
        default: { return vec3f(-place.x, -place.y, -1.0); }
    }
}

// The solid angle of a small part of a face around a position, divided by its area.
fn solidity(place: vec2f) -> f32 {
    let square = 1.0 + dot(place, place);
    return 1.0 / (square * sqrt(square));
}

fn place_of(texel: vec2f, edge: u32) -> vec2f {
    return 2.0 * texel / f32(edge) - 1.0;
}

fn index_of(first: u32, edge: u32, face: u32, texel: vec2u) -> u32 {
    return first + (face * edge + texel.y) * edge + texel.x;
}

// The first level: the mean of samples distributed over each texel.
@compute @workgroup_size(8, 8)
fn take(@builtin(global_invocation_id) texel: vec3u) {
    let edge = level.edge;
    if any(texel.xy >= vec2u(edge)) {
        return;
    }
    var sum = vec4f(0.0);
    let side = cube_light.samples;
    for (var index = 0u; index < side * side; index++) {
        let part = (vec2f(vec2u(index % side, index / side)) + 0.5) / f32(side);
        let place = place_of(vec2f(texel.xy) + part, edge);
        let towards = cube_light.cube_from_world * direction_on(texel.z, place);
        let radiance = textureSampleLevel(cube, cube_sampler, towards, 0.0).rgb;
        let is_light = all(radiance >= vec3f(0.0)) && all(radiance <= vec3f(LARGEST_HALF));
        sum += select(vec4f(0.0), vec4f(radiance, 1.0), is_light) * solidity(place);
    }
    let mean = sum.rgb / max(sum.a, 1e-6);
    let radiance = mean * cube_light.factor + cube_light.added;
    levels[index_of(level.first, edge, texel.z, texel.xy)] = vec4f(min(radiance, vec3f(LARGEST_HALF)), 1.0);
}

// The next level: means over solid angle.
@compute @workgroup_size(8, 8)
fn halve(@builtin(global_invocation_id) texel: vec3u) {
    let edge = level.edge;
    if any(texel.xy >= vec2u(edge)) {
        return;
    }
    var sum = vec4f(0.0);
    for (var part = 0u; part < 4u; part++) {
        let source = 2u * texel.xy + vec2u(part & 1u, part >> 1u);
        let weight = solidity(place_of(vec2f(source) + 0.5, 2u * edge));
        sum += weight * vec4f(levels[index_of(level.finer, 2u * edge, texel.z, source)].rgb, 1.0);
    }
    levels[index_of(level.first, edge, texel.z, texel.xy)] = vec4f(sum.rgb / sum.a, 1.0);
}

fn texel_at(face: u32, texel: vec2u) -> vec3f {
    return levels[index_of(level.first, level.edge, face, texel)].rgb;
}

// A texel in bordered coordinates, beyond at most one edge: beyond it, the neighbour's texel.
fn bordered_texel(face: u32, texel: vec2u) -> vec3f {
    let edge = level.edge;
    if all(texel >= vec2u(1u)) && all(texel <= vec2u(edge)) {
        return texel_at(face, texel - 1u);
    }
    let at = cube_place(direction_on(face, place_of(vec2f(texel) - 0.5, edge)));
    return texel_at(at.face, min(vec2u(at.place * f32(edge)), vec2u(edge - 1u)));
}

// Writes a level with its borders to the map; a corner is the mean of the three faces that meet
// there.
@compute @workgroup_size(8, 8)
fn lay_out(@builtin(global_invocation_id) invocation: vec3u) {
    let edge = level.edge;
    let bordered = edge + 2u;
    let texel = invocation.xy;
    let face = invocation.z;
    if any(texel >= vec2u(bordered)) {
        return;
    }
    let inner = clamp(texel, vec2u(1u), vec2u(edge));
    var radiance = bordered_texel(face, inner);
    if all(inner != texel) {
        radiance += bordered_texel(face, vec2u(texel.x, inner.y));
        radiance += bordered_texel(face, vec2u(inner.x, texel.y));
        radiance /= 3.0;
    } else if any(inner != texel) {
        radiance = bordered_texel(face, texel);
    }
    let corner = level.corner + bordered * vec2u(face % 3u, face / 3u);
    textureStore(map, corner + texel, vec4f(radiance, 1.0));
}
