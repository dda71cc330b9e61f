// The tracer's view of a volume with one value per cell: the module package::volume of the cheap
// mode. package::volume::cells defines where its cells are stored.
//
// A surface looks the same from both sides, and lights and shadows itself. The first voxel cone
// tracers did the same (Crassin et al. 2011); it is kept for comparison and for small devices.

import package::volume::cells::{fetch, inside_share, load_part, parts_at, place_at, Place};

// A place in the volume where a sample may be taken: cheap to compute, and enough to detect empty
// space.
struct Probe {
    place: Place,
    parts: u32,
}

fn probe_volume(position_in_grid: vec3f, level: u32, direction: vec3f) -> Probe {
    let place = place_at(position_in_grid, level);
    return Probe(place, parts_at(place));
}

fn is_empty(probe: Probe) -> bool {
    return probe.parts == 0u;
}

// Whether a look-up is empty.
fn is_clear(position_in_grid: vec3f, level: u32) -> bool {
    return parts_at(place_at(position_in_grid, level)) == 0u;
}

// Isotropic cells have no orientation.
fn is_oblique(probe: Probe) -> bool {
    return false;
}

// Radiance around a probe times opacity, and opacity; the direction is ignored.
fn sample_probe(probe: Probe, direction: vec3f) -> vec4f {
    return inside_share(probe.place) * fetch(probe.place, 0u);
}

// Isotropic cells have no orientation.
fn wall_coverage(position_in_grid: vec3f, level: u32, axis: u32) -> vec2f {
    return vec2f(0.0);
}

// The value of `sample_probe` for one cell of a level, unfiltered.
fn load_cell(cell: vec3u, level: u32, direction: vec3f) -> vec4f {
    return load_part(cell, level, 0u);
}
