// The corners of triangles for the rasterizer. A pixel is a column of voxels: the picture is the
// grid seen along an axis, in walk order (footprint.wgsl), with the column (u, v) at the pixel
// (u, v).
//
// Vertices are pulled from storage buffers by number. Corners have the same bits in all three
// walks, so that all see the same fragments.

import package::constants::{RASTER_CONSERVATIVE, RASTER_METHOD, RASTER_THREE_PLANE};
import package::grid::grid;
import package::voxelize::footprint::{footprint, turn};
import package::voxelize::items::run;
import package::classics::raster::widen::widened;
import package::voxelize::triangles::load_triangle;

struct Corner {
    @invariant @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    // The axis along which the triangle is drawn.
    @location(1) @interpolate(flat) axis: u32,
}

// From columns to the clip space of a square picture with the edge of the grid's longest axis.
fn clip_position(column: vec2f) -> vec4f {
    let edge = f32(max(grid.dimensions.x, max(grid.dimensions.y, grid.dimensions.z)));
    return vec4f(column.x / edge * 2.0 - 1.0, 1.0 - column.y / edge * 2.0, 0.5, 1.0);
}

// With three planes, the instance is the plane to draw on.
@vertex
fn main(@builtin(vertex_index) vertex: u32, @builtin(instance_index) instance: u32) -> Corner {
    let index = vertex / 3u;
    let number = vertex % 3u;
    let triangle = load_triangle(index, run.first_draw, run.end_draw);
    let area = footprint(triangle);
    let axis = select(area.axis, instance, RASTER_METHOD == RASTER_THREE_PLANE);
    if area.is_degenerate || area.is_outside {
        // Culled: all corners at one point outside the picture.
        return Corner(vec4f(2.0, 2.0, 0.5, 1.0), index, axis);
    }
    let a = turn(triangle.a, axis).xy;
    let b = turn(triangle.b, axis).xy;
    let c = turn(triangle.c, axis).xy;
    var column = select(select(c, b, number == 1u), a, number == 0u);
    if RASTER_METHOD == RASTER_CONSERVATIVE {
        column = widened(a, b, c, area, number);
    }
    return Corner(clip_position(column), index, axis);
}
