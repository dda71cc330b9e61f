// The nodes of one level of an octree as wire boxes around their cells.
//
// Blue: nodes with their own cells. Orange: nodes that exist only for their neighbours.

import package::constants::CELL_PARTS;
import package::grid::grid;
import package::volume::octree::search::{find_node, node_parts};
import package::volume::octree::tree::corner_of;
import package::render::passes::voxel_view::cell_walk::{longest_walk, next_axis, walk_into, walked_on};
import package::render::passes::voxel_view::first_cube::first_cube;
import package::render::passes::voxel_view::view::{
    distance_to_edge, outline, picture, pixel_ray, voxel_view_settings, Ray,
};
import package::trace::view::view;
import package::volume::cells::load_part;

const OWN_COLOR: vec3f = vec3f(0.12, 0.5, 1.0);
const NEIGHBOR_COLOR: vec3f = vec3f(1.0, 0.35, 0.04);
// Width of a line in pixels.
const NODE_LINE_WIDTH: f32 = 0.8;

fn has_own_cells(node_cell: vec3u, parts: u32, level: u32) -> bool {
    var is_own = false;
    for (var octant = 0u; octant < 8u; octant++) {
        for (var part = 0u; part < CELL_PARTS; part++) {
            if ((parts >> part) & 1u) != 0u {
                let value = load_part(2u * node_cell + corner_of(octant), level - 1u, part);
                is_own = is_own || any(value != vec4f(0.0));
            }
        }
    }
    return is_own;
}

// The colour of the first line of a node that a ray meets before `end`; the ray is in units of
// nodes.
fn first_line(ray: Ray, level: u32, end: f32) -> vec4f {
    let size = vec3f((grid.dimensions + ((1u << level) - 1u)) >> vec3u(level));
    var walk = walk_into(ray.origin, ray.direction, size);
    let steps = longest_walk(size);
    for (var step = 0u; step < steps && walk.is_inside && walk.distance < end; step++) {
        let node_cell = vec3u(walk.cell);
        let parts = node_parts(find_node(node_cell, level));
        if parts != 0u {
            // The face through which the ray enters, and the one through which it leaves.
            let leave_axis = next_axis(walk);
            let leave = walk.next[leave_axis];
            let width = NODE_LINE_WIDTH * voxel_view_settings.pixel_slope;
            let near_edge = distance_to_edge(ray.origin + walk.distance * ray.direction, walk.axis);
            let far_edge = distance_to_edge(ray.origin + leave * ray.direction, leave_axis);
            if near_edge < width * walk.distance || (far_edge < width * leave && leave < end) {
                let is_own = has_own_cells(node_cell, parts, level);
                return vec4f(select(NEIGHBOR_COLOR, OWN_COLOR, is_own), 1.0);
            }
        }
        walk = walked_on(walk);
    }
    return vec4f(0.0);
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = voxel_view_settings.level;
    let hit = first_cube(pixel_ray(pixel, level), level);
    var shown = vec4f(0.02, 0.02, 0.03, 0.0);
    var end = 3e38;
    if hit.is_hit {
        let side = array<f32, 3>(0.3, 0.42, 0.22)[hit.axis];
        shown = vec4f(vec3f(side) * outline(hit.position, hit.axis, hit.distance), 1.0);
        // The margin keeps lines visible that coincide with the surface.
        end = 0.5 * hit.distance + 0.01;
    }
    let line = first_line(pixel_ray(pixel, level + 1u), level + 1u, end);
    if line.a > 0.0 {
        shown = line;
    }
    textureStore(picture, pixel, shown);
}
