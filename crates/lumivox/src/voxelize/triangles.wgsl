// The triangles of a batch: all draws one after another, transformed to grid space.

import package::constants::HAS_SHORT_INDICES;

// Pieces with a smaller coverage are dropped; about the resolution of 8 bits.
const SMALLEST_COVERAGE = 1.0 / 512.0;

// How vertices map to a texture.
struct TexturePlace {
    // The rows of the affine transform from the vertices' texture coordinates to the image's, and
    // the word offset of the coordinates of vertex 0.
    u_row: vec3f,
    word: u32,
    v_row: vec3f,
    padding: u32,
}

// A run of triangles with one transform and one material.
struct Draw {
    // The rows of the affine transform from the positions to grid space.
    grid_from_local_x: vec4f,
    grid_from_local_y: vec4f,
    grid_from_local_z: vec4f,
    // Factors of the textures. Emission is relative to the scale of all materials' emission.
    reflectance: vec4f,
    emission: vec3f,
    // The first triangle in the batch's numbering.
    first_triangle: u32,
    // The first index, counted from the start of the index buffer, and the offset added to each
    // index.
    first_index: u32,
    base_vertex: u32,
    // Bits named in package::constants: DOUBLE_SIDED, OPEN_BEHIND, ALPHA_IS_COVERAGE, HAS_COLORS,
    // HAS_FLOAT_COLORS, HAS_BYTE_COLORS, HAS_SHORT_INDICES.
    flags: u32,
    transmission: f32,
    reflectance_place: TexturePlace,
    emission_place: TexturePlace,
    transmission_place: TexturePlace,
    // Words from one vertex's attributes to the next one's, and the word offset of the colour of
    // vertex 0.
    vertex_words: u32,
    color_word: u32,
    // The word offset of the position of vertex 0, and the words from one position to the next.
    position_word: u32,
    position_words: u32,
    // Light that the surface mirrors (voxels::list::Face).
    gloss: vec3f,
    // A bit for each cascade whose walked part it may touch.
    cascades: u32,
}

@group(1) @binding(0) var<storage, read> positions: array<f32>;
// Texture coordinates and colours, laid out as the draws say.
@group(1) @binding(1) var<storage, read> attributes: array<u32>;
@group(1) @binding(2) var<storage, read> indices: array<u32>;
@group(1) @binding(3) var<storage, read> draws: array<Draw>;

// A triangle in grid space.
struct Triangle {
    a: vec3f,
    b: vec3f,
    c: vec3f,
    vertices: vec3u,
    draw: u32,
}

// The draw that a triangle belongs to, among the draws in [first, end).
fn find_draw(triangle: u32, first: u32, end: u32) -> u32 {
    var low = first;
    var high = end;
    // Invariant: the draw is in [low, high).
    while high - low > 1u {
        let middle = (low + high) / 2u;
        if draws[middle].first_triangle <= triangle {
            low = middle;
        } else {
            high = middle;
        }
    }
    return low;
}

fn position_in_grid(draw: u32, vertex: u32) -> vec3f {
    let word = draws[draw].position_word + draws[draw].position_words * vertex;
    let p = vec3f(positions[word], positions[word + 1u], positions[word + 2u]);
    let x = draws[draw].grid_from_local_x;
    let y = draws[draw].grid_from_local_y;
    let z = draws[draw].grid_from_local_z;
    return vec3f(
        fma(x.x, p.x, fma(x.y, p.y, fma(x.z, p.z, x.w))),
        fma(y.x, p.x, fma(y.y, p.y, fma(y.z, p.z, y.w))),
        fma(z.x, p.x, fma(z.y, p.y, fma(z.z, p.z, z.w))),
    );
}

// An index, counted from the start of the buffer.
fn load_index(number: u32, is_short: bool) -> u32 {
    if is_short {
        return extractBits(indices[number / 2u], 16u * (number % 2u), 16u);
    }
    return indices[number];
}

// `first_draw` and `end_draw` bound the search for the triangle's draw.
fn load_triangle(triangle: u32, first_draw: u32, end_draw: u32) -> Triangle {
    let draw = find_draw(triangle, first_draw, end_draw);
    let first = draws[draw].first_index + 3u * (triangle - draws[draw].first_triangle);
    let base = draws[draw].base_vertex;
    let is_short = (draws[draw].flags & HAS_SHORT_INDICES) != 0u;
    let vertices = vec3u(
        load_index(first, is_short),
        load_index(first + 1u, is_short),
        load_index(first + 2u, is_short),
    ) + base;
    return Triangle(
        position_in_grid(draw, vertices.x),
        position_in_grid(draw, vertices.y),
        position_in_grid(draw, vertices.z),
        vertices,
        draw,
    );
}
