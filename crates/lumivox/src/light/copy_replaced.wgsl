// Copies the irradiance of a new list's faces from the previous list: from the nearest face of the
// same lobe of the same voxel. After a clipmap's box has moved, a voxel's place in storage may have
// held another voxel, a whole box away.

import package::cascades::cascade_of;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::voxels::list::Face;
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<storage, read> faces: array<Face>;
@group(1) @binding(1) var<storage, read> old_occupancy: array<u32>;
@group(1) @binding(2) var<storage, read> old_ranks: array<u32>;
@group(1) @binding(3) var<storage, read> old_first_faces: array<u32>;
@group(1) @binding(4) var<storage, read> old_faces: array<Face>;
@group(1) @binding(5) var<storage, read> old_irradiance: array<vec4f>;
@group(1) @binding(6) var<storage, read_write> irradiance: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&faces) {
        return;
    }
    let face = faces[index];
    let word = face.cell / 32u;
    let bits = old_occupancy[word];
    if (bits & (1u << (face.cell % 32u))) == 0u {
        return;
    }
    let first = old_first_faces[old_ranks[word] + bits_below(bits, face.cell % 32u)];
    var least = 4.0 * grid.voxel_size_m * exp2(f32(cascade_of(morton_decode(face.cell))));
    for (var i = first; i < arrayLength(&old_faces) && old_faces[i].cell == face.cell; i++) {
        let apart = distance(old_faces[i].position_in_world, face.position_in_world);
        if old_faces[i].lobe == face.lobe && apart < least {
            irradiance[index] = old_irradiance[i];
            least = apart;
        }
    }
}
