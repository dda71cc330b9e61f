// The report's cones, as `package::cones::model`. The values: x is the share of radiance that is
// lost per cone width, in longest sides of the grid; y is the gain per level, in powers of two; z
// is not zero if directions are drawn at random; w is not zero if cones start clear of walls. 0, 0,
// 1, 1 is the physics.

import package::cones::hemisphere::inner_ring;
import package::cones::start::clear_of_walls;

// A cone without random draw points at the middle of its cell, or along the normal if it is the
// inner ring's only cone.
fn place_in_cell(drawn: vec2f, cell: u32, cell_count: u32, values: vec4f) -> vec2f {
    let middle = vec2f(select(0.5, 0.0, cell == 0u && inner_ring(cell_count) == 1u), 0.5);
    return select(middle, drawn, values.z != 0.0);
}

// Without random draws the half vector is always the lobe's middle; the mean over frames is then no
// longer the integral.
fn glossy_half_vector(drawn: vec3f, values: vec4f) -> vec3f {
    return select(vec3f(0.0, 0.0, 1.0), drawn, values.z != 0.0);
}

fn start_of_cones(above: vec3f, normal: vec3f, level: u32, values: vec4f) -> vec3f {
    return select(above, clear_of_walls(above, normal, level), values.w != 0.0);
}

// Brightens coarse levels, up to a full cell's radiance, and dims wide cones.
fn shown_share(taken: f32, transmittance: f32, level: u32, width: f32, values: vec4f) -> f32 {
    let gain = exp2(f32(level) * values.y);
    let gained = min(taken * gain, max(transmittance, taken));
    return select(taken, gained, taken > 0.0) * max(1.0 - values.x * width, 0.0);
}
