// Shared by all views of voxels: settings, picture, a pixel's ray, outlines.

import package::cascades::lowest_cell;
import package::grid::grid_from_world;
import package::trace::view::{position_from_depth, view};

struct VoxelViewSettings {
    // The level of the cells to show.
    level: u32,
    // Height of a pixel at a distance of 1.
    pixel_slope: f32,
    padding_0: u32,
    padding_1: u32,
}

@group(1) @binding(0) var<uniform> voxel_view_settings: VoxelViewSettings;
@group(1) @binding(1) var picture: texture_storage_2d<rgba32float, write>;

// A depth at which two points of a ray are far enough apart for f32 to resolve the ray's direction:
// a thousand times the distance of the near plane.
const FAR_DEPTH: f32 = 0.001;
// Cells with less opacity count as empty: half floats cannot store their radiance to 1 %.
const MIN_OPACITY: f32 = 0.001;
// The width of the outline of a cube's faces, as a share of its edge, and its brightness factor.
const OUTLINE_WIDTH: f32 = 0.04;
const OUTLINE_LIGHT: f32 = 0.7;

// A ray in units of cells of a level, from the corner of their box.
struct Ray {
    origin: vec3f,
    // Unit length.
    direction: vec3f,
}

fn pixel_ray(pixel: vec2u, level: u32) -> Ray {
    let origin = grid_from_world(view.position_in_world) * exp2(-f32(level)) - vec3f(lowest_cell(level));
    let target_point = position_from_depth(pixel, FAR_DEPTH);
    return Ray(origin, normalize(target_point - view.position_in_world));
}

// The distance of a point of a face across an axis from the nearest edge of its cell; at most 1/2.
fn distance_to_edge(position: vec3f, axis: u32) -> f32 {
    let from_corner = fract(position);
    var to_edge = min(from_corner, 1.0 - from_corner);
    to_edge[axis] = 1.0;
    return min(to_edge.x, min(to_edge.y, to_edge.z));
}

// 1 on a face, less near its edges; fades out where a pixel is as wide as the outline of many
// cubes.
fn outline(position: vec3f, axis: u32, distance: f32) -> f32 {
    let pixel = distance * voxel_view_settings.pixel_slope;
    let strength = saturate(1.5 - 5.0 * pixel);
    let is_line = distance_to_edge(position, axis) < max(OUTLINE_WIDTH, pixel);
    return select(1.0, mix(1.0, OUTLINE_LIGHT, strength), is_line);
}
