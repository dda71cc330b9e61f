// The cells of the dense volume, as filtered look-ups see them: the module package::volume::cells.

import package::constants::ISOTROPIC;
import package::grid::grid;
import package::volume::dense::atlas::{part_texel, slab_of};
import package::volume::dense::masks::parts_near;

@group(0) @binding(3) var atlas: texture_3d<f32>;
@group(0) @binding(4) var atlas_sampler: sampler;

// Where a filtered look-up reads.
struct Place {
    position_in_grid: vec3f,
    level: u32,
}

fn place_at(position_in_grid: vec3f, level: u32) -> Place {
    return Place(position_in_grid, level);
}

// All parts that a look-up at a place can meet.
fn parts_at(place: Place) -> u32 {
    return parts_near(place.position_in_grid, place.level);
}

// A part of the cells around a place, trilinear, clamped to its slab.
fn fetch(place: Place, part: u32) -> vec4f {
    let extent = vec3f(grid.dimensions);
    let half_cell = 0.5 * exp2(f32(place.level));
    let inside = clamp(place.position_in_grid, vec3f(half_cell), extent - half_cell);
    let slabs = select(3.0, 1.0, ISOTROPIC != 0u);
    let uvw = (inside + vec3f(slab_of(part)) * extent) / (extent * vec3f(1.0, slabs, slabs));
    return textureSampleLevel(atlas, atlas_sampler, uvw, f32(place.level));
}

// A part of one cell, unfiltered.
fn load_part(cell: vec3u, level: u32, part: u32) -> vec4f {
    return textureLoad(atlas, part_texel(cell, part, level), level);
}
