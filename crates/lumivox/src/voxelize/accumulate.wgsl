// Sums up the faces' attributes as integers, so that the order of the triangles does not matter.
//
// The sums are stored in the list of faces itself, in place of the means (resolve.wgsl).

import package::constants::{
    DOUBLE_SIDED, FACE_CELL, FACE_EMISSION, FACE_FLAGS, FACE_GLOSS, FACE_LOBE, FACE_MASK_HIGH,
    FACE_MASK_LOW, FACE_POSITION, FACE_PROFILES, FACE_REFLECTANCE, FACE_VECTOR_AREA, FACE_WORDS,
    GLASS, LINEAR_WORKGROUP_SIZE, OPEN_BEHIND, SINGLE_SIDED,
};
import package::gpu::random::hash;
import package::voxelize::cover::{Cover, cover_of};
import package::voxelize::faces::VoxelFaces;
import package::voxelize::items::{Item, find_item};
import package::voxelize::piece::{Piece, piece_in_voxel};
import package::voxelize::plane_keys::{Plane, apart, key_of, plane_of, plane_of_walk};
import package::voxelize::surface::{SurfaceMap, surface_at, surface_map, PIERCED, UNIFORM, VARIED};
import package::voxelize::triangles::{SMALLEST_COVERAGE, draws};
import package::voxelize::needs::Needs;
import package::voxelize::footprint::turn_back;
import package::voxelize::walk::{Walk, walk_begin, walk_cell, walk_on};
import package::voxels::list::{faces_before, faces_in};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// The occupancy bits and the rank of each word of the finest level.
@group(2) @binding(1) var<storage, read> cells: array<vec2u>;
@group(2) @binding(2) var<storage, read> voxels: array<VoxelFaces>;
// Per face, three signed numbers each: vector area and, weighted by the area along the lobe,
// reflectance, gloss, emission and position within the voxel; one for the area of holes; and bits:
// the face's cover (cover.wgsl), its flags, and the key of its plane.
@group(2) @binding(3) var<storage, read_write> sums: array<atomic<u32>>;
@group(2) @binding(4) var<uniform> needs: Needs;

// A random number that depends only on the triangle's corners and the voxel, not on the triangle's
// place in the list.
fn seed_of(walk: ptr<function, Walk>) -> u32 {
    let a = bitcast<vec3u>((*walk).a);
    let b = bitcast<vec3u>((*walk).b);
    let c = bitcast<vec3u>((*walk).c);
    return hash(a.x + hash(a.y + hash(a.z + hash(b.x + hash(b.y + hash(b.z + hash(c.x + hash(c.y + hash(c.z)))))))));
}

// Adds three numbers, rounded up or down at random, so that many terms below 1 add up to the right
// sum.
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
    voxel: u32,
    // Factor that converts the terms to integers.
    scale: f32,
    plane: Plane,
    cover: Cover,
    // Terms of the sums; all but the vector area are weighted by the area along the lobe.
    vector_area: vec3f,
    reflectance: vec3f,
    position: vec3f,
    emission: vec3f,
    gloss: vec3f,
    // The area along the lobe that light passes through.
    holes: f32,
    // SINGLE_SIDED if light does not pass from behind; GLASS if it passes by transmission.
    flags: u32,
}

// Among the faces of a voxel's lobe, the one with the nearest plane.
fn nearest_face(voxel: u32, lobes: u32, lobe: u32, plane: Plane) -> u32 {
    var nearest = 0u;
    var least = 1e9;
    for (var i = 0u; i < faces_in(lobes, lobe); i++) {
        let between = apart(plane, plane_of(voxels[voxel].planes[4u * lobe + i], lobe));
        if between < least {
            least = between;
            nearest = i;
        }
    }
    return nearest;
}

// Sets bits that other pieces may have set.
fn add_bits(word: u32, bits: u32) {
    if (atomicLoad(&sums[word]) & bits) != bits {
        atomicOr(&sums[word], bits);
    }
}

// Adds a piece to the face of its plane, and to that of the opposite lobe if it is double-sided.
//
// Written as loops, so that a software GPU, which runs both sides of every `if`, also skips
// unneeded work.
fn add_to_faces(piece: WeightedPiece, lobe: u32, sides: u32, seed: u32) {
    let lobes = voxels[piece.voxel].lobes;
    let all_rows = 7u
        | select(0u, 8u, any(piece.gloss != vec3f(0.0)))
        | select(0u, 16u, any(piece.emission > vec3f(0.0)))
        | select(0u, 32u, piece.holes > 0.0);
    for (var side = 0u; side < sides; side++) {
        let own = lobe ^ side;
        if faces_in(lobes, own) == 0u {
            continue;
        }
        let face = voxels[piece.voxel].first_face + faces_before(lobes, own)
            + nearest_face(piece.voxel, lobes, own, piece.plane);
        let first = face * FACE_WORDS;
        add_bits(first + FACE_MASK_LOW, piece.cover.mask.x);
        add_bits(first + FACE_MASK_HIGH, piece.cover.mask.y);
        for (var i = 0u; i < 4u; i++) {
            add_bits(first + FACE_PROFILES + i, piece.cover.profiles[i]);
        }
        add_bits(first + FACE_FLAGS, piece.flags);
        atomicMax(&sums[first + FACE_LOBE], key_of(piece.plane, own));
        let vector_area = select(piece.vector_area, -piece.vector_area, side == 1u);
        var rows = all_rows;
        loop {
            let row = countTrailingZeros(rows);
            rows &= rows - 1u;
            var place = FACE_VECTOR_AREA;
            var value = vector_area;
            if row == 1u {
                place = FACE_REFLECTANCE;
                value = piece.reflectance;
            } else if row == 2u {
                place = FACE_POSITION;
                value = piece.position;
            } else if row == 3u {
                place = FACE_GLOSS;
                value = piece.gloss;
            } else if row == 4u {
                place = FACE_EMISSION;
                value = piece.emission;
            } else if row == 5u {
                place = FACE_CELL;
                value = vec3f(piece.holes, 0.0, 0.0);
            }
            add(first + place, value * piece.scale, seed + 8u * side + row);
            continuing {
                break if rows == 0u;
            }
        }
    }
}

// Values that are constant over a triangle.
struct Summing {
    map: SurfaceMap,
    // The lobe of its normal, and its number of sides.
    lobe: u32,
    sides: u32,
    seed: u32,
    // Vector area divided by projected area.
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
fn add_piece(
    walk: ptr<function, Walk>,
    summing: Summing,
    piece: Piece,
    cover: Cover,
    is_there: bool,
    detail: u32,
) {
    let surface = surface_at(walk, summing.map, piece.centroid, detail);
    let code = morton_encode(walk_cell(walk));
    let cell = cells[code / 32u];
    let is_occupied = (cell.x & (1u << (code % 32u))) != 0u;
    if is_there && is_occupied && piece.area > 0.0 && surface.coverage >= SMALLEST_COVERAGE {
        let voxel = cell.y + bits_below(cell.x, code % 32u);
        let area = piece.area * surface.coverage;
        let is_open = (draws[(*walk).draw].flags & OPEN_BEHIND) != 0u;
        let position = turn_back(piece.centroid - vec3f((*walk).voxel), (*walk).axis);
        let weighted = WeightedPiece(
            voxel,
            bitcast<f32>(voxels[voxel].area_low),
            plane_of_walk(walk),
            cover,
            summing.normal * area,
            surface.reflectance * area,
            position * area,
            surface.emission * area,
            draws[(*walk).draw].gloss * area,
            piece.area - area,
            select(0u, SINGLE_SIDED, summing.sides == 1u && detail != PIERCED && !is_open)
                | select(0u, GLASS, detail == PIERCED && draws[(*walk).draw].transmission > 0.0),
        );
        add_to_faces(weighted, summing.lobe, summing.sides, hash(summing.seed + code));
    }
}

fn accumulate(item: Item, detail: u32) {
    var walk = walk_begin(item);
    let summing = summing_begin(&walk);
    var is_there = walk_on(&walk);
    loop {
        let piece = piece_in_voxel(&walk);
        add_piece(&walk, summing, piece, cover_of(&walk, piece.centroid), is_there, detail);
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
    if needs.overflow == 0u {
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
    if needs.overflow == 0u {
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
    if needs.overflow == 0u {
        accumulate(find_item(invocation, workgroups, local), PIERCED);
    }
}
