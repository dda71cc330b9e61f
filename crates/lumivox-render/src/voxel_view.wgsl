// The voxels of one level as cubes: a walk along each pixel's ray from cell to cell (Amanatides and Woo 1987,
// "A fast voxel traversal algorithm for ray tracing").

import package::grid::{grid, grid_from_world};
import package::light::environment::environment_background;
import package::trace::gbuffer::{position_from_depth, view};
import package::volume::load_cell;

struct VoxelViewSettings {
    // The level that is shown.
    level: u32,
    // Height of a pixel at a distance of 1.
    pixel_slope: f32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> voxel_view_settings: VoxelViewSettings;
@group(1) @binding(1) var picture: texture_storage_2d<rgba32float, write>;

// A depth at which two points of a ray are far enough apart for f32 to hold its direction: a thousand times the
// distance of the near plane.
const FAR_DEPTH: f32 = 0.001;
// Cells that cover less are empty: half floats do not hold the radiance of less to 1 %.
const MIN_OPACITY: f32 = 0.001;
// How wide the outline of a cube's faces is, as a share of its edge, and how much light it leaves.
const OUTLINE_WIDTH: f32 = 0.04;
const OUTLINE_LIGHT: f32 = 0.7;

struct Hit {
    is_hit: bool,
    // Radiance towards the eye.
    radiance: vec3f,
    // In cells.
    distance: f32,
    position: vec3f,
    axis: u32,
}

// `origin` in cells, `direction` of unit length.
fn first_cube(origin: vec3f, direction: vec3f) -> Hit {
    let level = voxel_view_settings.level;
    let size = vec3f(grid.dimensions >> vec3u(level));
    let miss = Hit(false, vec3f(0.0), 0.0, vec3f(0.0), 0u);
    // A direction along a plane never crosses it: a large number stands for infinity.
    let inverse = select(1.0 / direction, vec3f(1e30), abs(direction) < vec3f(1e-12));
    let to_low = -origin * inverse;
    let to_high = (size - origin) * inverse;
    let enter = min(to_low, to_high);
    let leave = max(to_low, to_high);
    let start = max(max(enter.x, enter.y), max(enter.z, 0.0));
    let end = min(leave.x, min(leave.y, leave.z));
    if end <= start {
        return miss;
    }
    var axis = 2u;
    if enter.x >= start {
        axis = 0u;
    } else if enter.y >= start {
        axis = 1u;
    }
    let forward = select(vec3f(-1.0), vec3f(1.0), direction >= vec3f(0.0));
    var cell = clamp(floor(origin + start * direction), vec3f(0.0), size - 1.0);
    var next = (cell + max(forward, vec3f(0.0)) - origin) * inverse;
    next = select(next, vec3f(1e30), abs(direction) < vec3f(1e-12));
    var distance = start;
    let steps = u32(size.x + size.y + size.z);
    for (var step = 0u; step < steps; step++) {
        let seen = load_cell(vec3u(cell), level, direction);
        if seen.a > MIN_OPACITY {
            // What the face shows straight on, where it shows anything: a wall and a floor that share a cell
            // are each on their own side of the cube.
            var inwards = vec3f(0.0);
            inwards[axis] = forward[axis];
            let face = load_cell(vec3u(cell), level, inwards);
            var radiance = seen.rgb / seen.a;
            if face.a > MIN_OPACITY {
                radiance = face.rgb / face.a;
            }
            return Hit(true, radiance, distance, origin + distance * direction, axis);
        }
        axis = 2u;
        if next.x <= next.y && next.x <= next.z {
            axis = 0u;
        } else if next.y <= next.z {
            axis = 1u;
        }
        distance = next[axis];
        next[axis] += abs(inverse[axis]);
        cell[axis] += forward[axis];
        if cell[axis] < 0.0 || cell[axis] >= size[axis] {
            return miss;
        }
    }
    return miss;
}

// 1 on a face, less near its edges; fades out where a pixel is as wide as the outline of many cubes.
fn outline(hit: Hit) -> f32 {
    let from_corner = fract(hit.position);
    var to_edge = min(from_corner, 1.0 - from_corner);
    to_edge[hit.axis] = 1.0;
    let nearest = min(to_edge.x, min(to_edge.y, to_edge.z));
    let pixel = hit.distance * voxel_view_settings.pixel_slope;
    let strength = saturate(1.5 - 5.0 * pixel);
    return select(1.0, mix(1.0, OUTLINE_LIGHT, strength), nearest < max(OUTLINE_WIDTH, pixel));
}

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let cell_size = f32(1u << voxel_view_settings.level);
    let origin = grid_from_world(view.position_in_world) / cell_size;
    let target_point = position_from_depth(pixel, FAR_DEPTH);
    let direction = normalize(target_point - view.position_in_world);
    let hit = first_cube(origin, direction);
    if hit.is_hit {
        textureStore(picture, pixel, vec4f(hit.radiance * outline(hit), 1.0));
    } else {
        textureStore(picture, pixel, vec4f(environment_background(direction), 0.0));
    }
}
