// Traces the rays of faces: each once, and anew where surface has moved.
//
// A kernel of its own, since machines without branches would trace in each gather what they then leave out.

import package::cascades::cascade_of;
import package::cones::hemisphere::{basis, cell_cone};
import package::cones::ray::{trace_ray, Passed, Ray};
import package::cones::way::cone_start;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::light::turn::{
    counts, face_in_turn, face_jitter, faces, first_fresh, hits, is_fresh, settings, FACE_RAYS, HIT_OFFSET, HIT_WORDS,
    RAY_CLASSES,
};
import package::volume::patch::UNLIT;
import package::voxels::list::HIDDEN;
import package::voxels::morton::morton_decode;

const UNKNOWN = 0u;

// Whether a ray has to be traced: it never was, its group is due after surface has moved, or it starts on dynamic surface or has met
// some, whose faces have no fixed places in the list.
fn is_outdated(hit: u32, face: u32, ray: u32) -> bool {
    let met = hit - HIT_OFFSET;
    let is_moving = face >= counts.fixed_faces || (met >= counts.fixed_faces && met < UNLIT);
    let is_in_turn = ((settings.rays_anew >> (ray % RAY_CLASSES)) & 1u) != 0u;
    return hit == UNKNOWN || is_in_turn || (is_moving && settings.rays_anew != 0u);
}

fn find_at(index: u32) {
    let face = faces[index];
    if (face.flags & HIDDEN) != 0u {
        return;
    }
    let normal = normalize(face.vector_area);
    let level = cascade_of(morton_decode(face.cell));
    let origin = cone_start(face.position_in_world, normal, level, settings.cones);
    let world_from_normal = basis(normal);
    let jitter = face_jitter(face);
    var passed = Passed(0u, true, 1.0);
    for (var i = 0u; i < FACE_RAYS; i++) {
        let place = index * HIT_WORDS + i;
        if is_outdated(hits[place], index, i) {
            let direction = world_from_normal * cell_cone(i, FACE_RAYS, jitter).direction;
            hits[place] = trace_ray(Ray(origin, direction, 3e38, level), &passed).face + HIT_OFFSET;
        }
    }
}

// The faces whose turn it is.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = face_in_turn(linear_index(invocation, workgroups));
    if index < counts.faces {
        find_at(index);
    }
}

// Faces that have never gathered and whose turn it is not.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn fresh(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = first_fresh() + linear_index(invocation, workgroups);
    if is_fresh(index) {
        find_at(index);
    }
}
