// The cells of the octree for filtered look-ups: the module package::volume::cells.

import package::grid::grid;
import package::volume::border::border_weight;
import package::volume::octree::search::{brick_of, find_node, node_mask, node_parts};
import package::volume::octree::tree::{brick_origin, octant_of, tree};

@group(0) @binding(3) var atlas: texture_3d<f32>;
@group(0) @binding(4) var atlas_sampler: sampler;

// Location of a filtered look-up.
struct Place {
    position_in_grid: vec3f,
    level: u32,
    // The first cell along each axis that the look-up reads.
    first: vec3u,
    node: u32,
    // All parts that the look-up can contain.
    parts: u32,
}

fn place_at(position_in_grid: vec3f, level: u32) -> Place {
    let cells = vec3i(grid.dimensions >> vec3u(level));
    // The second of the cells that are read. Farther than half a cell outside the grid, everything
    // is empty.
    let second = vec3i(floor(position_in_grid * exp2(-f32(level)) + 0.5));
    if any(second < vec3i(0)) || any(second > cells) {
        return Place(position_in_grid, level, vec3u(0u), 0u, 0u);
    }
    let first = vec3u(max(second - 1, vec3i(0)));
    let node = find_node(first >> vec3u(1u), level + 1u);
    return Place(position_in_grid, level, first, node, node_mask(node, octant_of(first)));
}

// All parts that a look-up at a place can contain.
fn parts_at(place: Place) -> u32 {
    return place.parts;
}

// Trilinear sample of a part of the cells around a place; zero if the node does not have the part.
fn fetch(place: Place, part: u32) -> vec4f {
    if ((node_parts(place.node) >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    let position = place.position_in_grid * exp2(-f32(place.level));
    // The position between the centres of the first and the second cell, clamped to the grid.
    let last = vec3f(grid.dimensions >> vec3u(place.level)) - 0.5;
    let share = saturate(min(position, last) - 0.5 - vec3f(place.first));
    let texel = brick_origin(brick_of(place.node, part)) + (place.first & vec3u(1u));
    let uvw = (vec3f(texel) + 0.5 + share) * tree.inverse_size;
    return textureSampleLevel(atlas, atlas_sampler, uvw, 0.0);
}

// The share of a look-up that falls on cells of the grid.
fn inside_share(place: Place) -> f32 {
    return border_weight(place.position_in_grid, place.level, 0u);
}

// A part of one cell, unfiltered.
fn load_part(cell: vec3u, level: u32, part: u32) -> vec4f {
    let node = find_node(cell >> vec3u(1u), level + 1u);
    if ((node_parts(node) >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    return textureLoad(atlas, brick_origin(brick_of(node, part)) + (cell & vec3u(1u)), 0);
}
