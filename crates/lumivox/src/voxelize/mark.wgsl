// Sets a bit for each voxel that a triangle touches, in Morton order.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::voxelize::items::find_item;
import package::voxelize::overlap::{side_tests, touches};
import package::voxelize::piece::piece_in_voxel;
import package::voxelize::surface::{surface_at, surface_map, PIERCED};
import package::voxelize::triangles::SMALLEST_COVERAGE;
import package::voxelize::walk::{Walk, walk_begin, walk_cell, walk_on};
import package::voxels::morton::morton_encode;

@group(2) @binding(1) var<storage, read_write> occupancy: array<atomic<u32>>;

fn mark(walk: ptr<function, Walk>) {
    let code = morton_encode(walk_cell(walk));
    let bit = 1u << (code % 32u);
    // Reads first: if many triangles share a voxel, reads are cheap, but writes would be
    // serialized.
    if (atomicLoad(&occupancy[code / 32u]) & bit) == 0u {
        atomicOr(&occupancy[code / 32u], bit);
    }
}

// Surfaces that block all light.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn opaque(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    var walk = walk_begin(find_item(invocation, workgroups, local));
    let tests = side_tests(&walk);
    var is_there = walk_on(&walk);
    loop {
        if is_there && touches(&walk, tests) {
            mark(&walk);
        }
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
}

// Surfaces that let light through. Voxels in which the surface has no coverage stay empty.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn covered(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    var walk = walk_begin(find_item(invocation, workgroups, local));
    let tests = side_tests(&walk);
    let map = surface_map(&walk);
    var is_there = walk_on(&walk);
    loop {
        if is_there && touches(&walk, tests) {
            let piece = piece_in_voxel(&walk);
            if piece.area > 0.0 {
                let surface = surface_at(&walk, map, piece.centroid, PIERCED);
                if surface.coverage >= SMALLEST_COVERAGE {
                    mark(&walk);
                }
            }
        }
        continuing {
            is_there = walk_on(&walk);
            break if !is_there;
        }
    }
}
