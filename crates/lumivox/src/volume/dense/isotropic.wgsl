// The dense volume with one value a cell, as the tracer sees it: the module package::volume of the cheap mode.
//
// A surface looks the same from both sides, and lights and hides itself: this is what the first voxel cone
// tracers did (Crassin et al. 2011), kept for comparison and for small devices.

import package::grid::grid;
import package::volume::border::border_weight;
import package::volume::masks::parts_near;

@group(0) @binding(3) var cells: texture_3d<f32>;
@group(0) @binding(4) var cells_sampler: sampler;

// A place in the volume where a sample may be taken: cheap to make, and enough to tell that nothing is there.
struct Probe {
    position_in_grid: vec3f,
    level: u32,
    parts: u32,
}

fn probe_volume(position_in_grid: vec3f, level: u32, direction: vec3f) -> Probe {
    return Probe(position_in_grid, level, parts_near(position_in_grid, level));
}

fn is_empty(probe: Probe) -> bool {
    return probe.parts == 0u;
}

// One value a cell tells no orientation.
fn is_oblique(probe: Probe) -> bool {
    return false;
}

// Radiance around a probe times opacity, and the opacity; the direction does not matter.
fn sample_probe(probe: Probe, direction: vec3f) -> vec4f {
    let uvw = probe.position_in_grid / vec3f(grid.dimensions);
    return border_weight(probe.position_in_grid, probe.level)
        * textureSampleLevel(cells, cells_sampler, uvw, f32(probe.level));
}

// One value a cell tells no orientation.
fn wall_coverage(position_in_grid: vec3f, axis: u32) -> vec2f {
    return vec2f(0.0);
}

// What `sample_probe` gives for one cell of a level, unfiltered.
fn load_cell(cell: vec3u, level: u32, direction: vec3f) -> vec4f {
    return textureLoad(cells, cell, level);
}
