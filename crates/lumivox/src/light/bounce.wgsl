// One bounce: faces gather the irradiance that the volume holds for them. Reflectance stays below one, so the repetition
// converges.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::gpu::random::{hash, random_pair};
import package::cones::cone::ConeSettings;
import package::cones::gather::gather;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;

struct BounceSettings {
    cones: ConeSettings,
    cone_count: u32,
    // The most faces that gather at a time, and the number of the time: they take turns.
    faces_at_a_time: u32,
    turn: u32,
    padding_0: u32,
}

@group(1) @binding(0) var<uniform> settings: BounceSettings;
@group(1) @binding(1) var<uniform> counts: ListCounts;
@group(1) @binding(2) var<storage, read> faces: array<Face>;
// In rgb; w is 1 once a face has gathered.
@group(1) @binding(3) var<storage, read_write> irradiance: array<vec4f>;

fn gather_at(index: u32) {
    let face = faces[index];
    let normal = normalize(face.vector_area);
    // A face keeps its jitter from bounce to bounce, so that the bounces converge to a fixed point.
    let start = random_pair(face.cell, hash(face.lobe));
    let gathered = gather(
        face.position_in_world, normal, normal, settings.cone_count, start, 0u, settings.cones);
    // A few cones may sum up below zero (cone.wgsl).
    irradiance[index] = vec4f(max(gathered.irradiance, vec3f(0.0)), 1.0);
}

// How many turns there are until all faces have gathered.
fn turns() -> u32 {
    let most = max(settings.faces_at_a_time, 1u);
    return max((counts.faces + most - 1u) / most, 1u);
}

// The faces whose turn it is.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let all = turns();
    let index = linear_index(invocation, workgroups) * all + settings.turn % all;
    if index < counts.faces {
        gather_at(index);
    }
}

// Faces of voxels that dynamic surface touches, which have never gathered and whose turn it is not.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn fresh(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = counts.fixed_faces + linear_index(invocation, workgroups);
    let all = turns();
    if index < counts.faces && index % all != settings.turn % all && irradiance[index].w == 0.0 {
        gather_at(index);
    }
}
