// The irradiance of faces straight from emitters. It changes only with the emitters and the surface
// in front of them. Each gather adds the stored value.

import package::cascades::cascade_of;
import package::constants::{HIDDEN, LINEAR_WORKGROUP_SIZE, RAY_CLASSES};
import package::emitters::cluster::{cluster_of, unite, unpack, Cluster};
import package::emitters::draw::emitters;
import package::emitters::emitter::emitter_of;
import package::emitters::gather::gather_emitters;
import package::gpu::dispatch::linear_index;
import package::gpu::random::{hash, random_pair};
import package::grid::grid_from_world;
import package::light::turn::{
    counts, face_in_turn, faces, first_fresh, irradiance, is_fresh, keep_from_emitters, may_meet,
    moved_box, settings, Box,
};
import package::voxels::morton::morton_decode;

// Turns of the sequence of points on emitters, and rays in each. Faces use the same points in every
// gather, so their noise does not average out over time; cones average it over many faces.
const TURNS: u32 = 2u;
const TURN_RAYS: u32 = 2u;

const ALL_CLASSES: u32 = (1u << RAY_CLASSES) - 1u;

// The box around all emitters.
fn emitters_box() -> Box {
    var all: Cluster;
    if emitters.count == 1u {
        all = cluster_of(emitter_of(emitters.records[0]));
    } else {
        // The root of their tree.
        let node = emitters.records[emitters.count];
        all = unite(unpack(node[0], node[1]), unpack(node[2], node[3]));
    }
    return Box(all.centre - all.half_size, all.centre + all.half_size);
}

// Whether the irradiance of a face has to be found again: if it was never found; after surface has
// moved, if the face is dynamic, so that its place in the list varies, or if its group is due and
// moved surface may be in front of emitters. Groups are of whole workgroups.
fn is_outdated(index: u32) -> bool {
    if settings.shines_on_all != 0u || irradiance[index].w == 0.0 {
        return true;
    }
    let classes = select(settings.rays_anew, ALL_CLASSES, settings.has_moved != 0u && index >= counts.fixed_faces);
    let group = index / LINEAR_WORKGROUP_SIZE % RAY_CLASSES;
    if ((classes >> group) & 1u) == 0u {
        return false;
    }
    return settings.boxes == 0u || index >= counts.fixed_faces
        || may_meet(
            grid_from_world(faces[index].position_in_world), emitters_box(), moved_box(RAY_CLASSES));
}

fn shine_on(index: u32) {
    if !is_outdated(index) {
        return;
    }
    let face = faces[index];
    if (face.flags & HIDDEN) != 0u {
        keep_from_emitters(index, vec3f(0.0));
        return;
    }
    let normal = normalize(face.vector_area);
    let start = random_pair(face.cell ^ 0x9e3779b9u, hash(face.lobe));
    let level = cascade_of(morton_decode(face.cell));
    var sum = vec3f(0.0);
    for (var i = 0u; i < TURNS; i++) {
        sum += gather_emitters(
            face.position_in_world, normal, normal, level, start, i, TURN_RAYS, settings.cones).irradiance;
    }
    keep_from_emitters(index, sum / f32(TURNS));
}

// The faces whose turn it is.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = face_in_turn(linear_index(invocation, workgroups));
    if index < counts.faces {
        shine_on(index);
    }
}

// Faces that have never gathered and do not gather in this turn: of a new list, or of voxels that
// dynamic surface touches.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn fresh(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = first_fresh() + linear_index(invocation, workgroups);
    if is_fresh(index) {
        shine_on(index);
    }
}
