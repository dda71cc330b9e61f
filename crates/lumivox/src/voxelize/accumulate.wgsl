// Sums up what the faces are made of: integers, so that the order of the triangles does not matter.
//
// The sums stand in the list of faces itself, each where its mean will be (resolve.wgsl).

import package::constants::{
    DOUBLE_SIDED, FACE_EMISSION, FACE_GLOSS, FACE_POSITION, FACE_REFLECTANCE, FACE_VECTOR_AREA,
    FACE_VISIBLE_AREA, FACE_WORDS, LINEAR_WORKGROUP_SIZE,
};
import package::gpu::random::hash;
import package::voxelize::faces::{NO_FRONTS, VoxelFaces};
import package::voxelize::fronts::visible_shares;
import package::voxelize::items::{Item, find_item};
import package::voxelize::piece::{Piece, piece_in_voxel};
import package::voxelize::surface::{SurfaceMap, surface_at, surface_map, PIERCED, UNIFORM, VARIED};
import package::voxelize::triangles::{SMALLEST_COVERAGE, draws};
import package::voxelize::verdict::Verdict;
import package::voxelize::footprint::turn_back;
import package::voxelize::walk::{Walk, walk_begin, walk_cell, walk_on};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// The occupancy bits and the rank of each word of the finest level.
@group(2) @binding(1) var<storage, read> cells: array<vec2u>;
@group(2) @binding(2) var<storage, read> voxels: array<VoxelFaces>;
// Per face, three signed numbers each: vector area and, weighted by the area along the lobe that no other layer
// hides, reflectance, gloss, emission and position within the voxel. Where there may be layers, that area, too. Behind
// all faces, the fronts of those that have some (fronts.wgsl).
@group(2) @binding(3) var<storage, read_write> sums: array<atomic<u32>>;
@group(2) @binding(4) var<uniform> verdict: Verdict;

// A random number of the triangle and the voxel alone: the triangle's place in the list has no part in it.
fn seed_of(walk: ptr<function, Walk>) -> u32 {
    let a = bitcast<vec3u>((*walk).a);
    let b = bitcast<vec3u>((*walk).b);
    let c = bitcast<vec3u>((*walk).c);
    return hash(a.x + hash(a.y + hash(a.z + hash(b.x + hash(b.y + hash(b.z + hash(c.x + hash(c.y + hash(c.z)))))))));
}

// Adds three numbers, rounded up or down at random, so that many parts below 1 add up to the right sum.
fn add(first: u32, value: vec3f, seed: u32) {
    let x = hash(seed);
    let y = hash(x);
    let random = vec3f(vec3u(x, y, hash(y)) >> vec3u(8u)) / 16777216.0;
    let rounded = vec3i(floor(value + random));
    for (var i = 0u; i < 3u; i++) {
        if rounded[i] != 0 {
            atomicAdd(&sums[first + i], u32(rounded[i]));
        }
    }
}

// A piece of surface in a voxel.
struct WeightedPiece {
    // The first face's place in `sums`, the factor that makes integers, and the voxel's lobes.
    first: u32,
    scale: f32,
    lobes: u32,
    // All but the vector area weighted by the area along the lobe.
    vector_area: vec3f,
    reflectance: vec3f,
    position: vec3f,
    emission: vec3f,
    gloss: vec3f,
    // The area along the lobe, if another layer may hide it, and the share that none does: on the lobe's side, and
    // on the opposite one.
    area: f32,
    visible: vec2f,
}

// Adds a piece to the face of its lobe, and of the opposite lobe if it has two sides.
//
// In loops and not one after the other: what is not needed is then left out on a software GPU as well, which
// goes through both sides of every `if`.
fn add_to_faces(piece: WeightedPiece, lobe: u32, sides: u32, seed: u32) {
    let all_rows = 7u
        | select(0u, 8u, piece.area > 0.0)
        | select(0u, 16u, any(piece.gloss != vec3f(0.0)))
        | select(0u, 32u, any(piece.emission > vec3f(0.0)));
    for (var side = 0u; side < sides; side++) {
        let own = lobe ^ side;
        if (piece.lobes & (1u << own)) == 0u {
            continue;
        }
        let first = piece.first + bits_below(piece.lobes, own) * FACE_WORDS;
        let vector_area = select(piece.vector_area, -piece.vector_area, side == 1u);
        let visible = piece.visible[side];
        var rows = all_rows;
        loop {
            let row = countTrailingZeros(rows);
            rows &= rows - 1u;
            var place = FACE_VECTOR_AREA;
            var value = vector_area;
            if row == 1u {
                place = FACE_REFLECTANCE;
                value = visible * piece.reflectance;
            } else if row == 2u {
                place = FACE_POSITION;
                value = visible * piece.position;
            } else if row == 3u {
                place = FACE_VISIBLE_AREA;
                value = vec3f(visible * piece.area, 0.0, 0.0);
            } else if row == 4u {
                place = FACE_GLOSS;
                value = visible * piece.gloss;
            } else if row == 5u {
                place = FACE_EMISSION;
                value = visible * piece.emission;
            }
            add(first + place, value * piece.scale, seed + 8u * side + row);
            continuing {
                break if rows == 0u;
            }
        }
    }
}

// What does not change over a triangle.
struct Summing {
    map: SurfaceMap,
    // Of its normal, and how many sides it has.
    lobe: u32,
    sides: u32,
    seed: u32,
    // Vector area over projected area.
    normal: vec3f,
}

fn summing_begin(walk: ptr<function, Walk>) -> Summing {
    return Summing(
        surface_map(walk),
        2u * (*walk).axis + select(0u, 1u, (*walk).normal.z < 0.0),
        select(1u, 2u, (draws[(*walk).draw].flags & DOUBLE_SIDED) != 0u),
        seed_of(walk),
        turn_back((*walk).normal / abs((*walk).normal.z), (*walk).axis),
    );
}

// Adds the piece in the walk's current voxel, if there is one.
fn add_piece(walk: ptr<function, Walk>, summing: Summing, piece: Piece, is_there: bool, detail: u32) {
    let surface = surface_at(walk, summing.map, piece.centroid, detail);
    let code = morton_encode(walk_cell(walk));
    let cell = cells[code / 32u];
    let is_occupied = (cell.x & (1u << (code % 32u))) != 0u;
    if is_there && is_occupied && piece.area > 0.0 && surface.coverage >= SMALLEST_COVERAGE {
        let faces = voxels[cell.y + bits_below(cell.x, code % 32u)];
        let area = piece.area * surface.coverage;
        let position = turn_back(piece.centroid - vec3f((*walk).voxel), (*walk).axis);
        let visible = visible_shares(walk, piece.centroid, faces, summing.lobe, summing.sides);
        let weighted = WeightedPiece(
            faces.first_face * FACE_WORDS,
            bitcast<f32>(faces.area_low),
            faces.lobes,
            summing.normal * area,
            surface.reflectance * area,
            position * area,
            surface.emission * area,
            draws[(*walk).draw].gloss * area,
            select(area, 0.0, faces.area_high == NO_FRONTS),
            visible,
        );
        add_to_faces(weighted, summing.lobe, summing.sides, hash(summing.seed + code));
    }
}

fn accumulate(item: Item, detail: u32) {
    var walk = walk_begin(item);
    let summing = summing_begin(&walk);
    var is_there = walk_on(&walk);
    loop {
        add_piece(&walk, summing, piece_in_voxel(&walk), is_there, detail);
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
}

// Materials without textures, on vertices without colours.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn plain(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if verdict.no_room == 0u {
        accumulate(find_item(invocation, workgroups, local), UNIFORM);
    }
}

// Materials with textures, or vertices with colours.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn varied(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if verdict.no_room == 0u {
        accumulate(find_item(invocation, workgroups, local), VARIED);
    }
}

// Materials that let light through.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn pierced(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    if verdict.no_room == 0u {
        accumulate(find_item(invocation, workgroups, local), PIERCED);
    }
}
