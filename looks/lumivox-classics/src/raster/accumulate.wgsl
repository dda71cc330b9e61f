// Adds fragments to their faces, as the exact walk does (voxelize/accumulate.wgsl).

import package::voxelize::accumulate::{add_piece, summing_begin};
import package::classics::raster::fragment::{IS_CONSERVATIVE, fragment_begin, fragment_on, piece_of};
import package::voxelize::cover::{Cover, cover_of};
import package::voxelize::piece::Piece;
import package::voxelize::surface::{PIERCED, UNIFORM, VARIED};
import package::voxelize::walk::Walk;

// A fragment of a pixel's centre represents the whole pixel.
fn cover_of_fragment(walk: ptr<function, Walk>, piece: Piece) -> Cover {
    if IS_CONSERVATIVE {
        return cover_of(walk, piece.centroid);
    }
    return Cover(vec2u(0xffffffffu), vec4u(0xffffffffu));
}

fn accumulate(position: vec2f, triangle: u32, axis: u32, detail: u32) {
    var walk: Walk;
    let fragment = fragment_begin(&walk, position, triangle, axis);
    var summing = summing_begin(&walk);
    // Each of the three planes rounds a triangle's fragments with its own seed.
    summing.seed += axis;
    var is_there = fragment.is_there;
    loop {
        let piece = piece_of(&walk, fragment);
        add_piece(&walk, summing, piece, cover_of_fragment(&walk, piece), is_there, detail);
        continuing {
            is_there = is_there && fragment_on(&walk);
            break if !is_there;
        }
    }
}

// Materials without textures, on vertices without colours.
@fragment
fn plain(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    accumulate(position.xy, triangle, axis, UNIFORM);
}

// Materials with textures, or vertices with colours.
@fragment
fn varied(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    accumulate(position.xy, triangle, axis, VARIED);
}

// Materials that let light through.
@fragment
fn pierced(
    @builtin(position) position: vec4f,
    @location(0) @interpolate(flat) triangle: u32,
    @location(1) @interpolate(flat) axis: u32,
) {
    accumulate(position.xy, triangle, axis, PIERCED);
}
