// The far light of single faces from their rays (far_light.wgsl) and the light that arrives at them
// (face_light.wgsl), before both are shared (share_far.wgsl).

import package::cascades::cascade_of;
import package::cones::hemisphere::{basis, cell_cone};
import package::cones::ray::shown_by;
import package::cones::trace_method::cone_growth;
import package::constants::{
    FAR_CELLS, FAR_TEXELS, HIDDEN, HIT_WORDS, LINEAR_WORKGROUP_SIZE, PI,
};
import package::environment::environment_radiance;
import package::gpu::dispatch::linear_index;
import package::gpu::texels::texel_place;
import package::grid::grid_from_world;
import package::light::reflected::reflected_from_all_around;
import package::light::turn::{
    counts, face_jitter, faces, hits, irradiance, settings, FACE_RAYS, HIT_OFFSET,
};
import package::volume::face_light::{pack_face_light, FaceLight};
import package::volume::far_light::{pack_far_light, FarLight, NEAR, NO_FAR_LIGHT};
import package::volume::patch::{NOTHING, UNLIT};
import package::volume::surface::far_cells;
import package::voxels::list::Face;
import package::voxels::morton::morton_decode;

@group(1) @binding(6) var<storage, read> direct: array<vec4f>;
@group(1) @binding(7) var far: texture_storage_2d<rgba32uint, write>;

// The far light of a ray that has met a surface, packed.
fn brought(index: u32, face: Face, met: u32) -> u32 {
    if met >= UNLIT || (face.flags & HIDDEN) != 0u {
        return NO_FAR_LIGHT;
    }
    let away = grid_from_world(faces[met].position_in_world) - grid_from_world(face.position_in_world);
    let near = NEAR * exp2(f32(cascade_of(morton_decode(face.cell))));
    if dot(away, away) < near * near {
        return NO_FAR_LIGHT;
    }
    return pack_far_light(FarLight(shown_by(met, settings.has_emitters == 0u), 0.0));
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
    var packed = array<u32, FAR_CELLS>();
    var open = 0u;
    for (var i = 0u; i < rays; i++) {
        let hit = hits[index * HIT_WORDS + i];
        let met = hit - HIT_OFFSET;
        packed[i] = select(NO_FAR_LIGHT, brought(index, face, met), hit != 0u);
        open |= u32(met == NOTHING) << i;
    }
    // The rays that leave the grid, a loop of their own: in closed rooms there are none.
    let world_from_normal = basis(normalize(face.vector_area));
    let jitter = face_jitter(face);
    loop {
        let i = firstTrailingBit(open) % FACE_RAYS;
        let local = cell_cone(i, FACE_RAYS, jitter);
        let growth = cone_growth(local.tan_half_angle, local.direction.z, settings.cones);
        let outside = environment_radiance(world_from_normal * local.direction, growth);
        if open != 0u {
            packed[i] = pack_far_light(FarLight(outside, 1.0));
        }
        open &= open - 1u;
        continuing {
            break if open == 0u;
        }
    }
    for (var texel = 0u; texel < rays / 4u; texel++) {
        let i = 4u * texel;
        let words = vec4u(packed[i], packed[i + 1u], packed[i + 2u], packed[i + 3u]);
        textureStore(far, texel_place(FAR_TEXELS * index + texel), words);
    }
    let reflected = reflected_from_all_around(face);
    let lights = (direct[index].rgb - face.emission) * PI / max(reflected, vec3f(1e-6));
    let gathered = irradiance[index];
    let weight = select(1.0, 0.0, (face.flags & HIDDEN) != 0u || gathered.w == 0.0);
    let words = pack_face_light(FaceLight(gathered.rgb, lights, reflected, weight));
    textureStore(far, texel_place(FAR_TEXELS * index + FAR_CELLS / 4u), words);
}
