// Adds the fragments' planes and areas to each voxel.

import package::voxelize::planes::{FIRST, SECOND, add_piece, lobe_bits, pieces};
import package::classics::raster::fragment::{fragment_begin, fragment_on, piece_of};
import package::voxelize::surface::{surface_at, surface_map, PIERCED};
import package::voxelize::triangles::SMALLEST_COVERAGE;
import package::voxelize::walk::Walk;

fn count_piece() {
    let before = atomicAdd(&pieces.low, 1u);
    if before == 0xffffffffu {
        atomicAdd(&pieces.high, 1u);
    }
}

// Surfaces that let no light through.
fn add_opaque(position: vec4f, triangle: u32, axis: u32, step: u32) {
    var walk: Walk;
    let fragment = fragment_begin(&walk, position.xy, triangle, axis);
    let lobes = lobe_bits(&walk);
    var is_there = fragment.is_there;
    loop {
        let piece = piece_of(&walk, fragment);
        if is_there && piece.area > 0.0 {
            add_piece(&walk, lobes, piece.area, step);
            if step == FIRST {
                count_piece();
            }
        }
        continuing {
            is_there = is_there && fragment_on(&walk);
            break if !is_there;
        }
    }
}

// Surfaces that let light through.
fn add_covered(position: vec4f, triangle: u32, axis: u32, step: u32) {
    var walk: Walk;
    let fragment = fragment_begin(&walk, position.xy, triangle, axis);
    let lobes = lobe_bits(&walk);
    let map = surface_map(&walk);
    var is_there = fragment.is_there;
    loop {
        let piece = piece_of(&walk, fragment);
        let surface = surface_at(&walk, map, piece.centroid, PIERCED);
        if is_there && piece.area > 0.0 && surface.coverage >= SMALLEST_COVERAGE {
            add_piece(&walk, lobes, piece.area, step);
            if step == FIRST {
                count_piece();
            }
        }
        continuing {
            is_there = is_there && fragment_on(&walk);
            break if !is_there;
        }
    }
}

@fragment
fn opaque(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    add_opaque(position, triangle, axis, FIRST);
}

@fragment
fn opaque_again(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    add_opaque(position, triangle, axis, SECOND);
}

@fragment
fn covered(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    add_covered(position, triangle, axis, FIRST);
}

@fragment
fn covered_again(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    add_covered(position, triangle, axis, SECOND);
}
