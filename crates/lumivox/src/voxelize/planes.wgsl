// Finds the planes in each voxel, which size the list of faces, and the area of its surface, which
// scales their sums.
//
// The pieces in a voxel belong to lobes, and those of a lobe to planes: two sides of a thin wall,
// or a lamp below a ceiling and the ceiling itself, are never merged. A plane is a key of 32 bits:
// its height along the lobe's axis at the voxel's middle, and its two slopes. A lobe has up to four
// planes, found in two order-independent walks: first the front and the back plane, then the two
// outermost of the rest. Any further pieces, as on curved surface, join the nearest plane.

import package::constants::{DOUBLE_SIDED, LINEAR_WORKGROUP_SIZE};
import package::voxelize::faces::AREAS_PER_UNIT;
import package::voxelize::items::{Item, find_item};
import package::voxelize::piece::piece_in_voxel;
import package::voxelize::plane_keys::{is_same, key_of, plane_of_walk};
import package::voxelize::surface::{surface_at, surface_map, PIERCED};
import package::voxelize::triangles::{SMALLEST_COVERAGE, draws};
import package::voxelize::walk::{Walk, walk_begin, walk_cell, walk_on};
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

struct AtomicVoxelFaces {
    lobes: atomic<u32>,
    area_low: atomic<u32>,
    area_high: atomic<u32>,
    first_face: u32,
    planes: array<atomic<u32>, 24>,
}

struct PieceCount {
    low: atomic<u32>,
    high: atomic<u32>,
}

// The occupancy bits and the rank of each word of the finest level.
@group(2) @binding(1) var<storage, read> cells: array<vec2u>;
@group(2) @binding(2) var<storage, read_write> voxels: array<AtomicVoxelFaces>;
@group(2) @binding(3) var<storage, read_write> pieces: PieceCount;

var<workgroup> group_pieces: atomic<u32>;

// The bits of the lobes that the walk's triangle belongs to.
fn lobe_bits(walk: ptr<function, Walk>) -> u32 {
    let pair = 3u << (2u * (*walk).axis);
    let one = select(0x15u, 0x2au, (*walk).normal.z < 0.0);
    let is_double_sided = (draws[(*walk).draw].flags & DOUBLE_SIDED) != 0u;
    return pair & select(one, 0x3fu, is_double_sided);
}

// Marks a piece's lobes and their front and back planes, and adds its area.
fn add_first(walk: ptr<function, Walk>, voxel: u32, lobes: u32, area: f32) {
    if (atomicLoad(&voxels[voxel].lobes) & lobes) != lobes {
        atomicOr(&voxels[voxel].lobes, lobes);
    }
    let amount = u32(ceil(area * AREAS_PER_UNIT));
    let before = atomicAdd(&voxels[voxel].area_low, amount);
    if before + amount < before {
        atomicAdd(&voxels[voxel].area_high, 1u);
    }
    let plane = plane_of_walk(walk);
    var left = lobes;
    while left != 0u {
        let lobe = countTrailingZeros(left);
        left &= left - 1u;
        let key = key_of(plane, lobe);
        atomicMax(&voxels[voxel].planes[4u * lobe], key);
        atomicMax(&voxels[voxel].planes[4u * lobe + 3u], ~key);
    }
}

// Marks the two outermost of the planes that are neither the front nor the back plane.
fn add_second(walk: ptr<function, Walk>, voxel: u32, lobes: u32) {
    let plane = plane_of_walk(walk);
    var left = lobes;
    while left != 0u {
        let lobe = countTrailingZeros(left);
        left &= left - 1u;
        let key = key_of(plane, lobe);
        let front = atomicLoad(&voxels[voxel].planes[4u * lobe]);
        let back = ~atomicLoad(&voxels[voxel].planes[4u * lobe + 3u]);
        if !is_same(key, front, lobe) && !is_same(key, back, lobe) {
            atomicMax(&voxels[voxel].planes[4u * lobe + 1u], key);
            atomicMax(&voxels[voxel].planes[4u * lobe + 2u], ~key);
        }
    }
}

// The two walks.
const FIRST = 0u;
const SECOND = 1u;

fn add_piece(walk: ptr<function, Walk>, lobes: u32, area: f32, step: u32) {
    let code = morton_encode(walk_cell(walk));
    let cell = cells[code / 32u];
    if (cell.x & (1u << (code % 32u))) == 0u {
        return;
    }
    let voxel = cell.y + bits_below(cell.x, code % 32u);
    if step == FIRST {
        add_first(walk, voxel, lobes, area);
    } else {
        add_second(walk, voxel, lobes);
    }
}

fn count_pieces(count: u32, local: u32) {
    atomicAdd(&group_pieces, count);
    workgroupBarrier();
    if local == 0u {
        let total = atomicLoad(&group_pieces);
        let before = atomicAdd(&pieces.low, total);
        if before + total < before {
            atomicAdd(&pieces.high, 1u);
        }
    }
}

// Surfaces that block all light.
fn walk_opaque(item: Item, local: u32, step: u32) {
    var walk = walk_begin(item);
    let lobes = lobe_bits(&walk);
    var count = 0u;
    var is_there = walk_on(&walk);
    loop {
        let piece = piece_in_voxel(&walk);
        if is_there && piece.area > 0.0 {
            add_piece(&walk, lobes, piece.area, step);
            count++;
        }
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
    if step == FIRST {
        count_pieces(count, local);
    }
}

// Surfaces that let light through.
fn walk_covered(item: Item, local: u32, step: u32) {
    var walk = walk_begin(item);
    let lobes = lobe_bits(&walk);
    let map = surface_map(&walk);
    var count = 0u;
    var is_there = walk_on(&walk);
    loop {
        let piece = piece_in_voxel(&walk);
        if is_there && piece.area > 0.0 {
            let surface = surface_at(&walk, map, piece.centroid, PIERCED);
            if surface.coverage >= SMALLEST_COVERAGE {
                add_piece(&walk, lobes, piece.area, step);
                count++;
            }
        }
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
    if step == FIRST {
        count_pieces(count, local);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn opaque(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    walk_opaque(find_item(invocation, workgroups, local), local, FIRST);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn opaque_again(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    walk_opaque(find_item(invocation, workgroups, local), local, SECOND);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn covered(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    walk_covered(find_item(invocation, workgroups, local), local, FIRST);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn covered_again(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    walk_covered(find_item(invocation, workgroups, local), local, SECOND);
}
