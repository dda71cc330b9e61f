// First of two steps for faces whose place in the list changes, since dynamic surface touches their
// voxels: saves their light. settle.wgsl copies it back.

import package::constants::{HAS_CELLS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::voxelize::former::NO_FACE;
import package::voxelize::needs::Needs;
import package::voxels::list::Face;

@group(1) @binding(0) var<uniform> needs: Needs;
@group(1) @binding(1) var<storage, read> united_faces: array<u32>;
@group(1) @binding(2) var<storage, read> moving_faces: array<Face>;
@group(1) @binding(3) var<storage, read> former_faces: array<u32>;
@group(1) @binding(4) var<storage, read> faces: array<Face>;
@group(1) @binding(5) var<storage, read> irradiance: array<vec4f>;
@group(1) @binding(6) var<storage, read> held: array<vec4f>;
// Indexed by moving face.
@group(1) @binding(7) var<storage, read_write> moving_irradiance: array<vec4f>;
@group(1) @binding(8) var<storage, read_write> moving_held: array<vec4f>;

// The face with the same lobe and the nearest position, among those of a voxel that start at
// `former`.
fn find_face(former: u32, own: Face) -> u32 {
    var found = NO_FACE;
    var least = 3e38;
    if former == NO_FACE {
        return found;
    }
    for (var i = former; i < arrayLength(&faces) && faces[i].cell == own.cell; i++) {
        let apart = distance(faces[i].position_in_world, own.position_in_world);
        if faces[i].lobe == own.lobe && apart < least {
            found = i;
            least = apart;
        }
    }
    return found;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let voxel = linear_index(invocation, workgroups);
    if needs.overflow != 0u || voxel >= needs.moving_voxels {
        return;
    }
    for (var face = united_faces[voxel]; face < united_faces[voxel + 1u]; face++) {
        let own = moving_faces[face];
        let former = find_face(former_faces[voxel], own);
        var light = vec4f(0.0);
        var in_cells = vec4f(0.0);
        if former != NO_FACE {
            light = irradiance[former];
            if HAS_CELLS != 0u {
                in_cells = held[former];
            }
        }
        moving_irradiance[face] = light;
        if HAS_CELLS != 0u {
            moving_held[face] = in_cells;
        }
    }
}
