// Finds the hits of faces' rays, and the adjacent faces: once each, and again after surface has
// moved.
//
// These are separate kernels, since GPUs without branches would repeat the search in each gather
// and discard its result.

import package::cascades::{cascade_of, voxel_of};
import package::cones::hemisphere::{basis, cell_cone};
import package::cones::ray::{trace_ray, Passed, Ray};
import package::cones::trace_method::cone_start;
import package::constants::{HIDDEN, HIT_WORDS, LINEAR_WORKGROUP_SIZE, RAY_CLASSES};
import package::gpu::dispatch::linear_index;
import package::grid::grid_from_world;
import package::light::turn::{
    counts, face_jitter, faces, first_fresh, hits, is_fresh, is_in_turn, may_meet, moved_box,
    settings, Box, FACES_BESIDE, FACE_RAYS, FIRST_BESIDE, HIT_OFFSET,
};
import package::volume::beside::{is_parted, patch_of, spot_at, start_of_face};
import package::volume::patch::{NOTHING, UNLIT};
import package::voxels::morton::morton_decode;

const UNKNOWN = 0u;

// Whether a hit or adjacent face has to be found again. In the face's turn: if it was never found,
// or if its group is due and moved surface may be in its way (`may_change`). In any turn after
// surface has moved: if one of the two faces is dynamic, so that its place in the list varies.
fn is_outdated(hit: u32, face: u32, ray: u32, is_due: bool, may_change: bool) -> bool {
    let met = hit - HIT_OFFSET;
    let is_moving = face >= counts.fixed_faces || (met >= counts.fixed_faces && met < UNLIT);
    let is_in_group = ((settings.rays_anew >> (ray % RAY_CLASSES)) & 1u) != 0u;
    return (is_due && (hit == UNKNOWN || (is_in_group && may_change)))
        || (hit != UNKNOWN && is_moving && settings.rays_anew != 0u);
}

fn is_due_to_look(index: u32) -> bool {
    return is_in_turn(index) || (index >= first_fresh() && is_fresh(index));
}

// Maximum distance of a hit from the mean position of its face, in voxels.
const FROM_MEAN = 4.0;
// More than the extent of a grid.
const BEYOND_GRID = 65536.0;

// A distance within which a ray has met the surface of its hit.
fn reach_of(hit: u32, origin: vec3f) -> f32 {
    let met = hit - HIT_OFFSET;
    if hit == UNKNOWN || met >= UNLIT {
        return BEYOND_GRID;
    }
    return distance(grid_from_world(faces[met].position_in_world), origin) + FROM_MEAN;
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
    let is_due = is_due_to_look(index);
    let around = moved_box(RAY_CLASSES);
    var outdated = 0u;
    for (var i = 0u; i < FACE_RAYS; i++) {
        let hit = hits[index * HIT_WORDS + i];
        let direction = world_from_normal * cell_cone(i, FACE_RAYS, jitter).direction;
        let end = origin + direction * reach_of(hit, origin);
        let may_change = settings.rays_anew != 0u
            && (settings.boxes == 0u || may_meet(origin, Box(end, end), around));
        outdated |= u32(is_outdated(hit, index, i, is_due, may_change)) << i;
    }
    // On wide machines, lanes trace their outdated rays together. The loop tests at its end:
    // software drivers run the body of a loop that tests at its start once more.
    var passed = Passed(0u, true, 1.0);
    loop {
        let i = firstTrailingBit(outdated) % FACE_RAYS;
        let direction = world_from_normal * cell_cone(i, FACE_RAYS, jitter).direction;
        let reach = select(-1.0, 3e38, outdated != 0u);
        let hit = trace_ray(Ray(origin, direction, reach, level), &passed);
        if outdated != 0u {
            hits[index * HIT_WORDS + i] = hit.face + HIT_OFFSET;
        }
        outdated &= outdated - 1u;
        continuing {
            break if outdated == 0u;
        }
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index < counts.faces {
        find_at(index);
    }
}

// The face of the same surface in the next voxel along an axis; NOTHING if other surface lies
// between.
fn face_beside(index: u32, axis: u32, step: f32) -> u32 {
    let own = voxel_of(morton_decode(faces[index].cell));
    let plane = patch_of(index);
    let normal = normalize(plane.normal);
    let start = vec3f(own.voxel) + start_of_face(index);
    var point = start;
    point[axis] += step;
    point[plane.lobe >> 1u] -= step * normal[axis] / normal[plane.lobe >> 1u];
    let found = spot_at(point, plane.lobe, normal, own.cascade);
    if found.face != NOTHING && is_parted(start, found.start, normal, own.cascade) {
        return NOTHING;
    }
    return found.face;
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn beside(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= counts.faces {
        return;
    }
    let is_due = is_due_to_look(index);
    let around = moved_box(RAY_CLASSES);
    let position = grid_from_world(faces[index].position_in_world);
    let may_change = settings.boxes == 0u
        || (all(position >= around.low) && all(position <= around.high));
    for (var i = 0u; i < FACES_BESIDE; i++) {
        let place = index * HIT_WORDS + FIRST_BESIDE + i;
        if is_outdated(hits[place], index, i, is_due, may_change) {
            let axis = ((faces[index].lobe >> 1u) + 1u + i / 2u) % 3u;
            hits[place] = face_beside(index, axis, select(-1.0, 1.0, (i & 1u) != 0u)) + HIT_OFFSET;
        }
    }
}
