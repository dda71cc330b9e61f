// Creates patches of faces, and writes the light that they show.

import package::cascades::voxel_of;
import package::constants::{LINEAR_WORKGROUP_SIZE, PATCH_WORDS};
import package::gpu::dispatch::linear_index;
import package::grid::grid_from_world;
import package::volume::patch::{pack_emission, pack_light, pack_normal, pack_offset, unpack_normal};
import package::voxels::counts::ListCounts;
import package::voxels::covered::across;
import package::voxels::list::{Face, lobe_axis};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(3) var<storage, read_write> patches: array<vec2u>;

fn pack_light_of(face: u32, light: vec3f) -> vec2u {
    return pack_light(light, faces[face].lobe, faces[face].flags);
}

// Runs after the list has changed. The next light update writes the light of new faces.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn surface(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face >= counts.faces {
        return;
    }
    let own = voxel_of(morton_decode(faces[face].cell));
    let corner = vec3f(own.voxel);
    let place = grid_from_world(faces[face].position_in_world) * exp2(-f32(own.cascade)) - corner;
    let normal = pack_normal(faces[face].vector_area);
    let first = PATCH_WORDS * face;
    let start = across(place, lobe_axis(faces[face].lobe));
    patches[first] = vec2u(normal, pack_offset(dot(unpack_normal(normal), place), start));
    patches[first + 1u] = vec2u(faces[face].mask_low, faces[face].mask_high);
    patches[first + 2u] = faces[face].profiles.xy;
    patches[first + 3u] = faces[face].profiles.zw;
    patches[first + 4u] = pack_light_of(face, radiance[face].rgb);
    patches[first + 5u] = pack_emission(faces[face].emission);
}

// Runs after the light has changed.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn light(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        patches[PATCH_WORDS * face + 4u] = pack_light_of(face, radiance[face].rgb);
    }
}

// For cones that sample emitters: light without emission.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn reflected_light(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        let reflected = max(radiance[face].rgb - faces[face].emission, vec3f(0.0));
        patches[PATCH_WORDS * face + 4u] = pack_light_of(face, reflected);
    }
}
