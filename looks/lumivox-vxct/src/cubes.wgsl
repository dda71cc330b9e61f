// Draws the voxels of one level as cubes, solid or as wires, coloured by themselves or by whether
// light reached them.

import package::constants::{VIEW_LIT, VIEW_WIRE_VOXELS};
import package::render::passes::voxel_view::cell_walk::{longest_walk, next_axis, walk_into, walked_on};
import package::render::passes::voxel_view::view::distance_to_edge;
import package::vxct::finish::background;
import package::vxct::uniform::{in_cube, settings};
import package::trace::view::{ray_direction, view};

@group(1) @binding(0) var voxels: texture_3d<f32>;
@group(1) @binding(1) var picture: texture_storage_2d<rgba32float, write>;

// Half the width of a line in pixels, but at most the share WIDEST of a cell, so that small cells
// keep their holes.
const HALF_WIDTH: f32 = 0.6;
const WIDEST: f32 = 0.12;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = u32(settings.level);
    let size = vec3f(textureDimensions(voxels, level));
    let direction = ray_direction(pixel);
    let slope = length(ray_direction(pixel + vec2u(1u, 0u)) - direction);
    let origin = (0.5 * in_cube(settings.camera_in_world) + 0.5) * size;
    let is_wire = settings.shown == VIEW_WIRE_VOXELS;
    let is_lit = settings.shown == VIEW_LIT;
    var walk = walk_into(origin, direction, size);
    let steps = longest_walk(size);
    var shown = vec4f(background(pixel) * settings.white, 0.0);
    if is_lit {
        shown = vec4f(0.02, 0.02, 0.03, 0.0);
    }
    for (var step = 0u; step < steps && walk.is_inside; step++) {
        let seen = textureLoad(voxels, vec3u(walk.cell), level);
        if seen.a > 0.0 {
            var is_met = true;
            if is_wire {
                let leave_axis = next_axis(walk);
                let leave = walk.next[leave_axis];
                let near = distance_to_edge(origin + walk.distance * direction, walk.axis);
                let far = distance_to_edge(origin + leave * direction, leave_axis);
                is_met = near < min(HALF_WIDTH * slope * walk.distance, WIDEST)
                    || far < min(HALF_WIDTH * slope * leave, WIDEST);
            }
            if is_met {
                let side = array<f32, 3>(0.75, 1.0, 0.6)[walk.axis];
                let has_light = any(seen.rgb > vec3f(0.0));
                let state = select(vec3f(0.12, 0.13, 0.16), vec3f(1.0, 0.78, 0.2), has_light) * side;
                shown = vec4f(select(seen.rgb * settings.white, state, vec3<bool>(is_lit)), 1.0);
                break;
            }
        }
        walk = walked_on(walk);
    }
    textureStore(picture, pixel, shown);
}
