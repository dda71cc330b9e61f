// The dense volume with one value a cell, as the tracer sees it: the module package::volume of the cheap mode.
//
// A surface looks the same from both sides, and lights and hides itself: this is what the first voxel cone
// tracers did (Crassin et al. 2011), kept for comparison and for small devices.

import package::grid::grid;
import package::volume::masks::lobes_near;

@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(4) var volume_sampler: sampler;

fn border_weight(position_in_grid: vec3f, level: f32) -> f32 {
    let scale = exp2(-level);
    let texel = position_in_grid * scale;
    let inside = vec3f(grid.dimensions) * scale - texel;
    let weight = saturate(texel + 0.5) * saturate(inside + 0.5);
    return weight.x * weight.y * weight.z;
}

// Radiance around a point times opacity, and the opacity; the direction does not matter.
fn sample_volume(position_in_grid: vec3f, level: f32, direction: vec3f) -> vec4f {
    if lobes_near(position_in_grid, level) == 0u {
        return vec4f(0.0);
    }
    let uvw = position_in_grid / vec3f(grid.dimensions);
    let fine = floor(level);
    let fraction = level - fine;
    let coarse = min(fine + 1.0, f32(grid.levels - 1u));
    return (1.0 - fraction) * border_weight(position_in_grid, fine)
            * textureSampleLevel(cells, volume_sampler, uvw, fine)
        + fraction * border_weight(position_in_grid, coarse)
            * textureSampleLevel(cells, volume_sampler, uvw, coarse);
}

// The same for one cell of a level, unfiltered.
fn load_cell(cell: vec3u, level: u32, direction: vec3f) -> vec4f {
    return textureLoad(cells, cell, level);
}
