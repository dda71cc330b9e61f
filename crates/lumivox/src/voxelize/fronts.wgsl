// Which layer is in front where several of one lobe share a voxel: a lamp just below a ceiling, a carpet, a picture.
//
// Faces are means over the surface in a voxel, and of two layers one behind the other only the front one is seen.
// So where a voxel has more surface than one layer can have, each of its faces gets a raster of SAMPLES^2 points over
// the voxel's side. Each point finds the layer that is closest to the side that the lobe looks to, as a maximum of
// integers, which needs no order. A piece then counts in the means by the share of its points at which it is that
// layer (a z-buffer in each voxel; Catmull 1974, "A subdivision algorithm for computer display of curved surfaces").

import package::constants::{FRONT_SAMPLES, FRONT_WORDS, LINEAR_WORKGROUP_SIZE};
import package::voxelize::accumulate::{cells, sums, verdict, voxels};
import package::voxelize::faces::{NO_FRONTS, VoxelFaces};
import package::voxelize::items::find_item;
import package::voxelize::lobes::lobe_bits;
import package::voxelize::piece::piece_in_voxel;
import package::voxelize::surface::{surface_at, surface_map, PIERCED};
import package::voxelize::walk::{Walk, walk_begin, walk_cell, walk_on};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// Depth in a voxel, in integers: finer than positions are known.
const DEPTH_UNITS = 1048576.0;

// Layers as close as this, in voxels, are one: rounding decides which of them is in front.
const SAME_LAYER = 1.0 / 2048.0;

// A piece that covers no point is compared with the surface at the point next to it, which may be curved.
const SAME_LAYER_BESIDE = 1.0 / 256.0;

// With more holes than this a surface hides nothing.
const HIDING_COVERAGE = 0.5;

// A point of the raster on the walk's triangle, in the current voxel.
struct FrontSample {
    is_covered: bool,
    // Of the triangle's plane; 0 and 1 are the voxel's sides.
    depth: f32,
}

// A square raster, turned a little within the voxel's side, so that it is even along diagonals as well.
fn sample_position(index: u32) -> vec2f {
    let p = (vec2f(vec2u(index % FRONT_SAMPLES, index / FRONT_SAMPLES)) + 0.5) / f32(FRONT_SAMPLES);
    return p + vec2f(p.y - 0.5, 0.5 - p.x) / f32(FRONT_SAMPLES);
}

fn is_left_of(p: vec2f, start: vec2f, end: vec2f, side: f32) -> bool {
    let along = end - start;
    let to = p - start;
    return (along.x * to.y - along.y * to.x) * side >= 0.0;
}

fn front_sample(walk: ptr<function, Walk>, index: u32) -> FrontSample {
    let p = vec2f((*walk).voxel.xy) + sample_position(index);
    let side = (*walk).normal.z;
    let depth = (*walk).a.z + dot((*walk).slope, p - (*walk).a.xy) - f32((*walk).voxel.z);
    let is_covered = depth >= 0.0 && depth < 1.0
        && is_left_of(p, (*walk).a.xy, (*walk).b.xy, side)
        && is_left_of(p, (*walk).b.xy, (*walk).c.xy, side)
        && is_left_of(p, (*walk).c.xy, (*walk).a.xy, side);
    return FrontSample(is_covered, depth);
}

// Larger in front; 0 is where nothing is. `lobe` looks along its axis if it is even, against it if it is odd.
fn front_of(depth: f32, lobe: u32) -> u32 {
    let height = select(depth, 1.0 - depth, (lobe & 1u) != 0u);
    return 1u + u32(clamp(height, 0.0, 1.0) * DEPTH_UNITS);
}

// The first word of a lobe's raster.
fn fronts_of(faces: VoxelFaces, lobe: u32) -> u32 {
    return faces.area_high + bits_below(faces.lobes, lobe) * FRONT_WORDS;
}

// The share of the current piece that no other layer hides, for its lobe and, if it has two sides, the opposite one.
fn visible_shares(
    walk: ptr<function, Walk>,
    centroid: vec3f,
    faces: VoxelFaces,
    lobe: u32,
    sides: u32,
) -> vec2f {
    let has_fronts = faces.area_high != NO_FRONTS;
    let count = select(0u, FRONT_SAMPLES * FRONT_SAMPLES, has_fronts);
    var covered = 0.0;
    var visible = vec2f(0.0);
    for (var index = 0u; index < count; index++) {
        let at = front_sample(walk, index);
        if at.is_covered {
            covered += 1.0;
            for (var side = 0u; side < sides; side++) {
                let front = atomicLoad(&sums[fronts_of(faces, lobe ^ side) + index]);
                let own = front_of(at.depth, lobe ^ side) + u32(SAME_LAYER * DEPTH_UNITS);
                visible[side] += select(0.0, 1.0, own >= front);
            }
        }
    }
    if !has_fronts {
        return vec2f(1.0);
    }
    if covered > 0.0 {
        return visible / covered;
    }
    let place = clamp(centroid.xy - vec2f((*walk).voxel.xy), vec2f(0.0), vec2f(0.999));
    let nearest = vec2u(place * f32(FRONT_SAMPLES));
    let index = nearest.x + nearest.y * FRONT_SAMPLES;
    let at = front_sample(walk, index);
    for (var side = 0u; side < sides; side++) {
        let front = atomicLoad(&sums[fronts_of(faces, lobe ^ side) + index]);
        let own = front_of(at.depth, lobe ^ side) + u32(SAME_LAYER_BESIDE * DEPTH_UNITS);
        visible[side] = select(0.0, 1.0, own >= front);
    }
    return visible;
}

// Puts the walk's triangle into the rasters of its current voxel.
fn add_fronts(walk: ptr<function, Walk>, lobes: u32) {
    let code = morton_encode(walk_cell(walk));
    let cell = cells[code / 32u];
    if (cell.x & (1u << (code % 32u))) == 0u {
        return;
    }
    let faces = voxels[cell.y + bits_below(cell.x, code % 32u)];
    if faces.area_high == NO_FRONTS {
        return;
    }
    for (var index = 0u; index < FRONT_SAMPLES * FRONT_SAMPLES; index++) {
        let at = front_sample(walk, index);
        var left = select(0u, lobes & faces.lobes, at.is_covered);
        while left != 0u {
            let lobe = countTrailingZeros(left);
            left &= left - 1u;
            atomicMax(&sums[fronts_of(faces, lobe) + index], front_of(at.depth, lobe));
        }
    }
}

// Surfaces that let no light through.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn opaque(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if verdict.no_room != 0u || verdict.fronts == 0u {
        return;
    }
    var walk = walk_begin(find_item(invocation, workgroups, local));
    let lobes = lobe_bits(&walk);
    var is_there = walk_on(&walk);
    loop {
        if is_there {
            add_fronts(&walk, lobes);
        }
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
}

// Surfaces that let light through.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn covered(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if verdict.no_room != 0u || verdict.fronts == 0u {
        return;
    }
    var walk = walk_begin(find_item(invocation, workgroups, local));
    let lobes = lobe_bits(&walk);
    let map = surface_map(&walk);
    var is_there = walk_on(&walk);
    loop {
        let piece = piece_in_voxel(&walk);
        let surface = surface_at(&walk, map, piece.centroid, PIERCED);
        if is_there && piece.area > 0.0 && surface.coverage >= HIDING_COVERAGE {
            add_fronts(&walk, lobes);
        }
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
}
