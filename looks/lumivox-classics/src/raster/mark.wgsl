// Marks the voxels of fragments: a bit each, in Morton order.

import package::voxelize::mark::mark;
import package::voxelize::overlap::side_tests;
import package::classics::raster::fragment::{fragment_begin, fragment_on, is_touched, piece_of};
import package::voxelize::surface::{surface_at, surface_map, PIERCED};
import package::voxelize::triangles::SMALLEST_COVERAGE;
import package::voxelize::walk::Walk;

// Surfaces that let no light through.
@fragment
fn opaque(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    var walk: Walk;
    let fragment = fragment_begin(&walk, position.xy, triangle, axis);
    let tests = side_tests(&walk);
    var is_there = fragment.is_there;
    loop {
        if is_there && is_touched(&walk, tests) {
            mark(&walk);
        }
        continuing {
            is_there = is_there && fragment_on(&walk);
            break if !is_there;
        }
    }
}

// Surfaces that let light through: voxels without any remaining surface stay free.
@fragment
fn covered(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    var walk: Walk;
    let fragment = fragment_begin(&walk, position.xy, triangle, axis);
    let map = surface_map(&walk);
    let tests = side_tests(&walk);
    var is_there = fragment.is_there;
    loop {
        let piece = piece_of(&walk, fragment);
        let surface = surface_at(&walk, map, piece.centroid, PIERCED);
        let is_left = piece.area > 0.0 && surface.coverage >= SMALLEST_COVERAGE;
        if is_there && is_left && is_touched(&walk, tests) {
            mark(&walk);
        }
        continuing {
            is_there = is_there && fragment_on(&walk);
            break if !is_there;
        }
    }
}
