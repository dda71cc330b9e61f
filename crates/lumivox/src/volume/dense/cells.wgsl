// The cells of the dense volume for filtered look-ups: the module package::volume::cells.

import package::cascades::{block_of, box_size, cascade_at, lowest_voxel};
import package::constants::{CASCADES, ISOTROPIC};
import package::grid::grid;
import package::volume::border::border_weight;
import package::volume::dense::atlas::{part_texel, slab_of};
import package::volume::dense::masks::parts_near;

@group(0) @binding(3) var atlas: texture_3d<f32>;
@group(0) @binding(4) var atlas_sampler: sampler;

// Location of a filtered look-up.
struct Place {
    // The position, in voxels of the cascade.
    position: vec3f,
    // The level of its cells minus the cascade's number.
    up: u32,
    cascade: u32,
}

fn place_at(position_in_grid: vec3f, level: u32) -> Place {
    let cascade = cascade_at(position_in_grid, level);
    return Place(position_in_grid * exp2(-f32(cascade)), level - cascade, cascade);
}

// All parts that a look-up at a place can contain.
fn parts_at(place: Place) -> u32 {
    return parts_near(place.position, place.up, place.cascade);
}

// The share of a look-up that falls on cells of the grid.
fn inside_share(place: Place) -> f32 {
    return border_weight(place.position, place.up, place.cascade);
}

// Trilinear sample at a position in storage, at least half a cell inside its box.
fn sample_stored(position: vec3f, part: u32, up: u32) -> vec4f {
    let extent = vec3f(grid.dimensions);
    let slabs = select(3.0, 1.0, ISOTROPIC != 0u);
    let uvw = (position + vec3f(slab_of(part)) * extent) / (extent * vec3f(1.0, slabs, slabs));
    return textureSampleLevel(atlas, atlas_sampler, uvw, f32(up));
}

// Trilinear sample of a part of the cells around a place, clamped to the part's slab.
fn fetch(place: Place, part: u32) -> vec4f {
    let low = vec3f(lowest_voxel(place.cascade));
    let size = vec3f(box_size());
    let half_cell = 0.5 * exp2(f32(place.up));
    let inside = clamp(place.position, low + half_cell, low + size - half_cell);
    if CASCADES == 0u {
        return sample_stored(inside, part, place.up);
    }
    let block = vec3f(block_of(place.cascade)) * size;
    let turned = inside - size * floor(inside / size);
    // Handles positions between the last and the first stored cell of a box, which are neighbours,
    // too (the box wraps around).
    let beyond = select(turned, turned - size, turned > 0.5 * size);
    let is_between = abs(beyond) < vec3f(half_cell);
    if !any(is_between) {
        return sample_stored(block + turned, part, place.up);
    }
    let axes = dot(select(vec3u(0u), vec3u(1u, 2u, 4u), is_between), vec3u(1u));
    let of_first = select(vec3f(1.0), 0.5 + 0.5 * beyond / half_cell, is_between);
    var sum = vec4f(0.0);
    // Bit mask of the axes along which the last cell is read; the loop runs over all subsets.
    var last = 0u;
    loop {
        let is_last = (vec3u(last) & vec3u(1u, 2u, 4u)) != vec3u(0u);
        let weights = select(of_first, 1.0 - of_first, is_last);
        let ends = select(vec3f(half_cell), size - half_cell, is_last);
        let position = block + select(turned, ends, is_between);
        sum += weights.x * weights.y * weights.z * sample_stored(position, part, place.up);
        last = (last - axes) & axes;
        continuing {
            break if last == 0u;
        }
    }
    return sum;
}

// A part of one cell, unfiltered.
fn load_part(cell: vec3u, level: u32, part: u32) -> vec4f {
    return textureLoad(atlas, part_texel(cell, part, level), level);
}
