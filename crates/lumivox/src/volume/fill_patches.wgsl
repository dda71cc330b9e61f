// Creates patches of faces, and writes the light that they show.

import package::cascades::voxel_of;
import package::constants::{LINEAR_WORKGROUP_SIZE, PATCH_TEXELS};
import package::gpu::dispatch::linear_index;
import package::gpu::texels::texel_place;
import package::grid::grid_from_world;
import package::volume::surface::Parts;
import package::volume::patch::{pack_emission, pack_light, pack_normal, pack_offset, unpack_normal};
import package::voxels::counts::ListCounts;
import package::voxels::covered::across;
import package::voxels::list::{Face, lobe_axis};
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> radiance: array<vec4f>;
@group(1) @binding(3) var<uniform> parts: Parts;
@group(1) @binding(4) var surface: texture_storage_2d<rgba32uint, write>;

fn store(face: u32, texel: u32, words: vec4u) {
    textureStore(surface, texel_place(parts.first_patch + PATCH_TEXELS * face + texel), words);
}

fn store_light(face: u32) {
    let emission = faces[face].emission;
    let reflected = max(radiance[face].rgb - emission, vec3f(0.0));
    let light = pack_light(reflected, faces[face].lobe, faces[face].flags);
    store(face, 2u, vec4u(light, pack_emission(emission)));
}

// Runs after the list has changed. The next light update writes the light of new faces.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn create(
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
    let start = across(place, lobe_axis(faces[face].lobe));
    let offset = pack_offset(dot(unpack_normal(normal), place), start);
    store(face, 0u, vec4u(normal, offset, faces[face].mask_low, faces[face].mask_high));
    store(face, 1u, faces[face].profiles);
    store_light(face);
}

// Runs after the light has changed.
@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn light(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        store_light(face);
    }
}
