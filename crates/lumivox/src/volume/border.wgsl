// Cells outside the grid are zero. Textures clamp to their edge instead, so a look-up near the
// border is weighted by the share of its trilinear filter that falls on cells of the grid.

import package::grid::grid;

fn border_weight(position_in_grid: vec3f, level: u32) -> f32 {
    let scale = exp2(-f32(level));
    let texel = position_in_grid * scale;
    let inside = vec3f(grid.dimensions) * scale - texel;
    let weight = saturate(texel + 0.5) * saturate(inside + 0.5);
    return weight.x * weight.y * weight.z;
}
