// The bricks of one level of an octree, pulled apart: each node's 3x3x3 texels are small cubes
// inside the node.
//
// The third texels along each axis are tinted orange: that layer belongs to the neighbours, and
// repeats their first cells.

import package::constants::ISOTROPIC;
import package::grid::grid;
import package::environment::environment_background;
import package::volume::octree::search::{brick_of, find_node, node_parts};
import package::volume::octree::tree::brick_origin;
import package::render::passes::voxel_view::cell_walk::{longest_walk, walk_into, walked_on};
import package::render::passes::voxel_view::view::{picture, pixel_ray, voxel_view_settings, Ray, MIN_OPACITY};
import package::trace::view::view;
import package::volume::cells::atlas;
import package::volume::parts::part_of;

// The gap on each side of a texel, as a share of its edge.
const GAP: f32 = 0.12;
const NEIGHBOR_TINT: vec3f = vec3f(1.0, 0.42, 0.08);

fn load_texel(node: u32, offset: vec3u, part: u32) -> vec4f {
    if ((node_parts(node) >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    return textureLoad(atlas, brick_origin(brick_of(node, part)) + offset, 0);
}

// The value of a texel seen from a direction: each side is weighted by how much it faces the
// viewer.
fn texel_towards(node: u32, offset: vec3u, direction: vec3f) -> vec4f {
    if ISOTROPIC != 0u {
        return load_texel(node, offset, 0u);
    }
    var sum = vec4f(0.0);
    for (var axis = 0u; axis < 3u; axis++) {
        let kind = select(2u, 1u, direction[axis] < 0.0);
        sum += abs(direction[axis]) * load_texel(node, offset, part_of(axis, kind));
    }
    return sum;
}

struct TexelHit {
    is_hit: bool,
    radiance: vec3f,
}

// Walks through the texels of one node; `ray` is in texels, from the node's corner.
fn first_texel(node: u32, ray: Ray) -> TexelHit {
    var walk = walk_into(ray.origin, ray.direction, vec3f(3.0));
    for (var step = 0u; step < 9u && walk.is_inside; step++) {
        let low = (walk.cell + GAP - ray.origin) * walk.inverse;
        let high = (walk.cell + 1.0 - GAP - ray.origin) * walk.inverse;
        let enter = min(low, high);
        let leave = max(low, high);
        let start = max(enter.x, max(enter.y, enter.z));
        if start < min(leave.x, min(leave.y, leave.z)) && start > 0.0 {
            let offset = vec3u(walk.cell);
            let seen = texel_towards(node, offset, ray.direction);
            if seen.a > MIN_OPACITY {
                var axis = 2u;
                if enter.x >= start {
                    axis = 0u;
                } else if enter.y >= start {
                    axis = 1u;
                }
                let side = array<f32, 3>(0.8, 1.0, 0.65)[axis];
                let tint = select(vec3f(1.0), NEIGHBOR_TINT, any(offset == vec3u(2u)));
                return TexelHit(true, seen.rgb / seen.a * tint * side);
            }
        }
        walk = walked_on(walk);
    }
    return TexelHit(false, vec3f(0.0));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let level = voxel_view_settings.level + 1u;
    let ray = pixel_ray(pixel, level);
    let size = vec3f((grid.dimensions + ((1u << level) - 1u)) >> vec3u(level));
    var walk = walk_into(ray.origin, ray.direction, size);
    let steps = longest_walk(size);
    var shown = vec4f(environment_background(ray.direction), 0.0);
    for (var step = 0u; step < steps && walk.is_inside; step++) {
        let node = find_node(vec3u(walk.cell), level);
        if node != 0u {
            let local = Ray(3.0 * (ray.origin - walk.cell), ray.direction);
            let hit = first_texel(node, local);
            if hit.is_hit {
                shown = vec4f(hit.radiance, 1.0);
                break;
            }
        }
        walk = walked_on(walk);
    }
    textureStore(picture, pixel, shown);
}
