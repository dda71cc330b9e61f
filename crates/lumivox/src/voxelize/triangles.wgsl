// The triangles of a batch: all draws one after another, brought into grid space.


// Of a piece with holes, when less than this share is left, it is not there: about what 8 bits can hold.
const SMALLEST_COVERAGE = 1.0 / 512.0;

// Where a vertex lies on a texture.
struct TexturePlace {
    // The rows of the affine transform from the vertices' coordinates to the image's, and the word of a vertex
    // at which those coordinates stand.
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
    // Factors of the textures. Emission is relative to the largest of all materials.
    reflectance: vec4f,
    emission: vec3f,
    // The first triangle in the batch's numbering.
    first_triangle: u32,
    // The first index in the index buffer, and what is added to each index.
    first_index: u32,
    base_vertex: u32,
    // Bits named in package::constants: DOUBLE_SIDED, ALPHA_IS_COVERAGE, HAS_COLORS.
    flags: u32,
    transmission: f32,
    reflectance_place: TexturePlace,
    emission_place: TexturePlace,
    transmission_place: TexturePlace,
    // Words of a vertex's attributes, and the word of its colour among them.
    vertex_words: u32,
    color_word: u32,
    padding_0: u32,
    padding_1: u32,
    // What the surface mirrors (voxels::list::Face).
    gloss: vec3f,
    padding_2: u32,
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

// The draw that a triangle belongs to, among the draws from `first` up to but not including `end`.
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
    let p = vec3f(positions[3u * vertex], positions[3u * vertex + 1u], positions[3u * vertex + 2u]);
    let x = draws[draw].grid_from_local_x;
    let y = draws[draw].grid_from_local_y;
    let z = draws[draw].grid_from_local_z;
    return vec3f(
        fma(x.x, p.x, fma(x.y, p.y, fma(x.z, p.z, x.w))),
        fma(y.x, p.x, fma(y.y, p.y, fma(y.z, p.z, y.w))),
        fma(z.x, p.x, fma(z.y, p.y, fma(z.z, p.z, z.w))),
    );
}

// `first_draw` and `end_draw` bound the search for the triangle's draw.
fn load_triangle(triangle: u32, first_draw: u32, end_draw: u32) -> Triangle {
    let draw = find_draw(triangle, first_draw, end_draw);
    let first = draws[draw].first_index + 3u * (triangle - draws[draw].first_triangle);
    let base = draws[draw].base_vertex;
    let vertices = vec3u(indices[first], indices[first + 1u], indices[first + 2u]) + base;
    return Triangle(
        position_in_grid(draw, vertices.x),
        position_in_grid(draw, vertices.y),
        position_in_grid(draw, vertices.z),
        vertices,
        draw,
    );
}
