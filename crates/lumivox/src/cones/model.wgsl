// The cone model: the start and direction of cones, and the share that each sample shows.
//
// This is the physical model, which ignores `values`. A caller's own model (`hooks::ConeModel`)
// replaces it as `package::cones::model`, with the same functions and its own `values`.

import package::cones::start::clear_of_walls;

// The position in its cell of the hemisphere, in [0, 1)^2, of a diffuse cone's direction; `drawn`
// is the position that the frame drew.
fn place_in_cell(drawn: vec2f, cell: u32, cell_count: u32, values: vec4f) -> vec2f {
    return drawn;
}

// The half vector at which a glossy cone is reflected, in the frame whose z is the normal; `drawn`
// is the half vector that the frame drew from the lobe.
fn glossy_half_vector(drawn: vec3f, values: vec4f) -> vec3f {
    return drawn;
}

// The start of cones, in the grid's coordinates; `above` is the point at the normal offset above
// the surface, `level` the level of the surface's voxels (0 without cascades).
fn start_of_cones(above: vec3f, normal: vec3f, level: u32, values: vec4f) -> vec3f {
    return clear_of_walls(above, normal, level);
}

// The share of a cone that shows a sample's radiance. `taken` is the part of the remaining
// transmittance that the sample absorbs, negative if it pays a surplus back (`march.wgsl`). `level`
// is the level of the sampled cells, `width` the cone's diameter there divided by the grid's
// longest side.
fn shown_share(taken: f32, transmittance: f32, level: u32, width: f32, values: vec4f) -> f32 {
    return taken;
}
