// Sums up what the faces are made of: integers, so that the order of the triangles does not matter.
//
// The sums stand in the list of faces itself, each where its mean will be (resolve.wgsl).

import package::constants::{
    ALPHA_IS_COVERAGE, DOUBLE_SIDED, FACE_EMISSION, FACE_POSITION, FACE_REFLECTANCE, FACE_VECTOR_AREA,
    FACE_WORDS, LINEAR_WORKGROUP_SIZE,
};
import package::gpu::random::hash;
import package::voxelize::faces::VoxelFaces;
import package::voxelize::items::find_item;
import package::voxelize::piece::{Piece, piece_in_voxel};
import package::voxelize::surface::{Surface, surface_at, texcoord_map};
import package::voxelize::triangles::{SMALLEST_COVERAGE, draws};
import package::voxelize::footprint::turn_back;
import package::voxelize::walk::{Walk, walk_begin, walk_cell, walk_on};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

// The occupancy bits and the rank of each word of the finest level.
@group(2) @binding(1) var<storage, read> cells: array<vec2u>;
@group(2) @binding(2) var<storage, read> voxels: array<VoxelFaces>;
// Per face, three signed numbers each: vector area and, weighted by the area along the lobe, reflectance,
// emission and position within the voxel.
@group(2) @binding(3) var<storage, read_write> sums: array<atomic<u32>>;

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
    let rounded = vec3i(trunc(value));
    for (var i = 0u; i < 3u; i++) {
        if rounded[i] != 0 {
            atomicAdd(&sums[first + i], u32(rounded[i]));
        }
    }
}

fn add_to_face(walk: ptr<function, Walk>, voxel: u32, lobe: u32, vector_area: vec3f, weight: f32,
    surface: Surface, position: vec3f, seed: u32) {
    let faces = voxels[voxel];
    if (faces.lobes & (1u << lobe)) == 0u {
        return;
    }
    let first = (faces.first_face + bits_below(faces.lobes, lobe)) * FACE_WORDS;
    let scale = bitcast<f32>(faces.area_low);
    add(first + FACE_VECTOR_AREA, vector_area * scale, seed);
    add(first + FACE_REFLECTANCE, surface.reflectance * (weight * scale), seed + 1u);
    add(first + FACE_EMISSION, surface.emission * (weight * scale), seed + 2u);
    add(first + FACE_POSITION, position * (weight * scale), seed + 3u);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    var walk = walk_begin(find_item(invocation, workgroups, local));
    let map = texcoord_map(&walk);
    let flags = draws[walk.draw].flags;
    let lobe = 2u * walk.axis + select(0u, 1u, walk.normal.z < 0.0);
    let seed = seed_of(&walk);
    // Vector area over projected area.
    let normal = turn_back(walk.normal / abs(walk.normal.z), walk.axis);
    while walk_on(&walk) {
        let piece = piece_in_voxel(&walk);
        if piece.area <= 0.0 {
            continue;
        }
        let code = morton_encode(walk_cell(&walk));
        let cell = cells[code / 32u];
        if (cell.x & (1u << (code % 32u))) == 0u {
            continue;
        }
        let voxel = cell.y + bits_below(cell.x, code % 32u);
        let surface = surface_at(&walk, map, piece.centroid);
        var area = piece.area;
        if (flags & ALPHA_IS_COVERAGE) != 0u {
            if surface.coverage < SMALLEST_COVERAGE {
                continue;
            }
            area *= surface.coverage;
        }
        let position = turn_back(piece.centroid - vec3f(walk.voxel), walk.axis);
        let piece_seed = hash(seed + code);
        add_to_face(&walk, voxel, lobe, normal * area, area, surface, position, piece_seed);
        if (flags & DOUBLE_SIDED) != 0u {
            add_to_face(&walk, voxel, lobe ^ 1u, -normal * area, area, surface, position, ~piece_seed);
        }
    }
}
