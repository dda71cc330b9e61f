// Where a filtered look-up falls: two levels with their weights.
//
// Outside the grid everything is zero. Textures clamp to their edge instead, so each level's value is weighted
// by the share of the trilinear filter that lies inside.

import package::grid::grid;

struct Footprint {
    position_in_grid: vec3f,
    fine: f32,
    coarse: f32,
    fine_weight: f32,
    coarse_weight: f32,
}

// The share of a trilinear look-up at a level that falls on cells of the grid.
fn level_weight(position_in_grid: vec3f, level: f32) -> f32 {
    let scale = exp2(-level);
    let texel = position_in_grid * scale;
    let inside = vec3f(grid.dimensions) * scale - texel;
    let weight = saturate(texel + 0.5) * saturate(inside + 0.5);
    return weight.x * weight.y * weight.z;
}

fn footprint_at(position_in_grid: vec3f, level: f32) -> Footprint {
    let fine = floor(level);
    let coarse = min(fine + 1.0, f32(grid.levels - 1u));
    let fraction = level - fine;
    return Footprint(
        position_in_grid,
        fine,
        coarse,
        (1.0 - fraction) * level_weight(position_in_grid, fine),
        fraction * level_weight(position_in_grid, coarse),
    );
}
