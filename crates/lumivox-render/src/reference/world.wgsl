// The scene for the path tracer: group 0, and its layout.
//
// Positions are relative to the centre of the scene, where f32 is most precise, with the world's
// axes, in metres. Radiance is in multiples of the renderer's unit.

import package::constants::REFERENCE_SPLIT;
import package::light::lights::Light;
import package::render::scene::material::Material;

// A box of the hierarchy. The two children of an inner box are adjacent.
struct Node {
    low: vec3f,
    // Inner box: the first child. Leaf: REFERENCE_LEAF, then the number of triangles minus one in
    // the three bits below, then the first triangle.
    link: u32,
    high: vec3f,
    padding: u32,
}

struct Triangle {
    corner: vec3f,
    // The first vertex, with TRIANGLE_DOUBLE_SIDED and TRIANGLE_SEE_THROUGH in the highest bits.
    vertex_0: u32,
    edge_1: vec3f,
    vertex_1: u32,
    edge_2: vec3f,
    vertex_2: u32,
}

struct Vertex {
    normal: vec3f,
    material: u32,
    tangent: vec4f,
    // Two sets of texture coordinates.
    texcoords: vec4f,
    // Four 16-bit channels.
    color: vec2u,
    padding: vec2u,
}

// The position of a texture in the atlas; `bits` are TILE_...
struct Tile {
    origin: vec2u,
    size: vec2u,
    layer: u32,
    bits: u32,
    padding: vec2u,
}

struct TracedMaterial {
    shown: Material,
    // Indexed by TEXTURE_...
    tiles: array<Tile, 8>,
    // The density, per m2, with which next-event estimation samples a point of this emitter.
    emitter_density: f32,
    // Exponent of a Phong lobe; 0: microfacets.
    phong_exponent: f32,
    padding: vec2u,
}

// An emissive triangle.
struct Emitter {
    triangle: u32,
    // The cumulative probability up to this emitter.
    cumulated: f32,
}

// A compact bright part of the panorama: the radiance above `around` within the cap.
struct Peak {
    direction: vec3f,
    cos_cap: f32,
    around: vec3f,
    padding: f32,
}

struct World {
    camera: vec3f,
    near_m: f32,
    forward: vec3f,
    light_count: u32,
    // To the right; the length is half the picture's width at a distance of one.
    right: vec3f,
    emitter_count: u32,
    up: vec3f,
    seed: u32,
    size: vec2u,
    // The rows of the film to trace.
    first_row: u32,
    row_count: u32,
    // Factor of the panorama's radiance.
    environment: vec3f,
    // The most path segments after the visible surface.
    most_bounces: u32,
    // Cosine and sine of the panorama's rotation about y.
    environment_turn: vec2f,
    peak_count: u32,
    occlusion_distance_m: f32,
    // The link of the hierarchy's root.
    root: u32,
    // The offset of rays from their surface.
    offset_m: f32,
    first_sample: u32,
    sample_count: u32,
    peaks: array<Peak, 4>,
}

const VERTEX_INDEX: u32 = 0x3fffffffu;

@group(0) @binding(0) var<uniform> world: World;
@group(0) @binding(1) var<storage, read> nodes: array<Node>;
@group(0) @binding(2) var<storage, read> triangles: array<Triangle>;
@group(0) @binding(3) var<storage, read> vertices: array<Vertex>;
@group(0) @binding(4) var<storage, read> materials: array<TracedMaterial>;
@group(0) @binding(5) var<storage, read> lights: array<Light>;
@group(0) @binding(6) var<storage, read> emitters: array<Emitter>;
// 8 bits a channel, as in the files.
@group(0) @binding(8) var atlas: texture_2d_array<f32>;
// Radiance; in a, the cumulative probability within the row.
@group(0) @binding(9) var panorama: texture_2d<f32>;
// One column: the cumulative probability of the rows.
@group(0) @binding(10) var panorama_rows: texture_2d<f32>;
// The triangles from REFERENCE_SPLIT on: the size of a buffer is limited.
@group(0) @binding(12) var<storage, read> more_triangles: array<Triangle>;

fn triangle_at(index: u32) -> Triangle {
    if index >= REFERENCE_SPLIT {
        return more_triangles[index - REFERENCE_SPLIT];
    }
    return triangles[index];
}
