// The dense volume with one value a cell, as the tracer sees it: the module package::volume of the cheap mode.
//
// A surface looks the same from both sides, and lights and hides itself: this is what the first voxel cone
// tracers did (Crassin et al. 2011), kept for comparison and for small devices.

import package::grid::grid;
import package::volume::footprint::footprint_at;
import package::volume::masks::parts_near;

@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(4) var cells_sampler: sampler;

// Radiance around a point times opacity, and the opacity; the direction does not matter.
fn sample_volume(position_in_grid: vec3f, level: f32, direction: vec3f) -> vec4f {
    let at = footprint_at(position_in_grid, level);
    if parts_near(at) == 0u {
        return vec4f(0.0);
    }
    let uvw = position_in_grid / vec3f(grid.dimensions);
    return at.fine_weight * textureSampleLevel(cells, cells_sampler, uvw, at.fine)
        + at.coarse_weight * textureSampleLevel(cells, cells_sampler, uvw, at.coarse);
}

// The same for one cell of a level, unfiltered.
fn load_cell(cell: vec3u, level: u32, direction: vec3f) -> vec4f {
    return textureLoad(cells, cell, level);
}
