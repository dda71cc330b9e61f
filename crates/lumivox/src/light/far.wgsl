// The far light of single faces from their rays (far_light.wgsl), before it is shared
// (share_far.wgsl).

import package::cascades::cascade_of;
import package::cones::hemisphere::{basis, cell_cone};
import package::cones::ray::shown_by;
import package::cones::trace_method::cone_growth;
import package::constants::{HIDDEN, HIT_WORDS, LINEAR_WORKGROUP_SIZE};
import package::environment::environment_radiance;
import package::gpu::dispatch::linear_index;
import package::grid::grid_from_world;
import package::light::turn::{counts, face_jitter, faces, hits, settings, FACE_RAYS, HIT_OFFSET};
import package::volume::far_light::{pack_far_light, FarLight, NEAR, NO_FAR_LIGHT};
import package::volume::patch::{NOTHING, UNLIT};
import package::volume::surface::far_cells;
import package::voxels::list::Face;
import package::voxels::morton::morton_decode;

@group(1) @binding(3) var<storage, read_write> far: array<u32>;

// The far light of one ray of a face, packed.
fn brought(index: u32, face: Face, ray: u32) -> u32 {
    let hit = hits[index * HIT_WORDS + ray];
    let met = hit - HIT_OFFSET;
    if met == NOTHING {
        let local = cell_cone(ray, FACE_RAYS, face_jitter(face));
        let direction = basis(normalize(face.vector_area)) * local.direction;
        let growth = cone_growth(local.tan_half_angle, local.direction.z, settings.cones);
        return pack_far_light(FarLight(environment_radiance(direction, growth), 1.0));
    }
    if hit == 0u || met >= UNLIT || (face.flags & HIDDEN) != 0u {
        return NO_FAR_LIGHT;
    }
    let away = grid_from_world(faces[met].position_in_world) - grid_from_world(face.position_in_world);
    let near = NEAR * exp2(f32(cascade_of(morton_decode(face.cell))));
    if dot(away, away) < near * near {
        return NO_FAR_LIGHT;
    }
    return pack_far_light(FarLight(shown_by(met), 0.0));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= counts.faces {
        return;
    }
    let face = faces[index];
    let rays = far_cells();
    for (var i = 0u; i < rays; i++) {
        far[index * FACE_RAYS + i] = brought(index, face, i);
    }
}
