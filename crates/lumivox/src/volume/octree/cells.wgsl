// The cells of the octree, as filtered look-ups see them: the module package::volume::cells.

import package::grid::grid;
import package::octree::search::{brick_of, find_node, node_mask};
import package::octree::tree::{brick_origin, corner_of, octant_of, tree, ALL_PARTS, NONE};

@group(0) @binding(3) var atlas: texture_3d<f32>;
@group(0) @binding(4) var atlas_sampler: sampler;

// Where a filtered look-up reads.
struct Place {
    position_in_grid: vec3f,
    level: u32,
    // Within a brick of the node, in texels: 1/2 to 5/2.
    texel: vec3f,
    node: u32,
    // All parts that the look-up can meet.
    parts: u32,
}

fn place_at(position_in_grid: vec3f, level: u32) -> Place {
    let cells = grid.dimensions >> vec3u(level);
    let position = position_in_grid * exp2(-f32(level));
    // What is farther out than half a cell meets nothing.
    let is_near = all(position >= vec3f(-0.5)) && all(position < vec3f(cells) + 0.5);
    let inside = clamp(position, vec3f(0.5), vec3f(cells) - 0.5);
    let first_cell = vec3u(inside - 0.5);
    let node_cell = first_cell >> vec3u(1u);
    var node = NONE;
    if is_near {
        node = find_node(node_cell, level + 1u);
    }
    let parts = select(0u, node_mask(node, octant_of(first_cell)), node != NONE);
    return Place(position_in_grid, level, inside - 2.0 * vec3f(node_cell), node, parts);
}

// All parts that a look-up at a place can meet.
fn parts_at(place: Place) -> u32 {
    return place.parts;
}

// A part of the cells around a place, trilinear; zero where the node does not have it.
fn fetch(place: Place, part: u32) -> vec4f {
    if place.node == NONE || ((node_mask(place.node, ALL_PARTS) >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    let texel = vec3f(brick_origin(brick_of(place.node, part))) + place.texel;
    return textureSampleLevel(atlas, atlas_sampler, texel * tree.inverse_size, 0.0);
}

// A part of one cell, unfiltered.
fn load_part(cell: vec3u, level: u32, part: u32) -> vec4f {
    let node = find_node(cell >> vec3u(1u), level + 1u);
    if node == NONE || ((node_mask(node, ALL_PARTS) >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    return textureLoad(atlas, brick_origin(brick_of(node, part)) + (cell & vec3u(1u)), 0);
}
