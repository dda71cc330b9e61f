// Averages far light and arriving light over adjacent faces: over a row of SHARING_FACES faces
// along one axis of their surface, then over rows along the other axis. With turn.wgsl's rays these
// 7 x 7 faces cover 784 evenly distributed directions. A row ends where other surface crosses it.
// The means of rows are kept where rays will read those of 7 x 7 faces.

import package::constants::{FAR_CELLS, FAR_TEXELS, HIT_WORDS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::gpu::texels::texel_place;
import package::light::turn::{FIRST_BESIDE, HIT_OFFSET, SHARING_FACES};
import package::volume::face_light::{pack_face_light, unpack_face_light};
import package::volume::far_light::{
    mean_of, pack_far_light, with_far_light, FarLight, FarSum, NO_FAR_LIGHT,
};
import package::volume::surface::Parts;
import package::voxels::counts::ListCounts;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> beside: array<u32>;
@group(1) @binding(2) var<uniform> parts: Parts;
@group(1) @binding(3) var far: texture_2d<u32>;
@group(1) @binding(4) var shared_far: texture_storage_2d<rgba32uint, write>;

fn last_texel(face: u32) -> u32 {
    return FAR_TEXELS * face + FAR_CELLS / 4u;
}

fn pack_mean(sum: FarSum) -> u32 {
    let mean = mean_of(sum);
    let packed = pack_far_light(FarLight(mean.radiance, mean.openness));
    return select(NO_FAR_LIGHT, packed, mean.is_known);
}

// `axis` is 0 or 1, for the two axes along the surface; `first` is the texel where the far light of
// the first face is read, and where it is written.
fn share(face: u32, axis: u32, first: vec2u) {
    // The faces of the row; a place beyond its end repeats the face.
    var row: array<u32, SHARING_FACES>;
    var are_in_row: array<bool, SHARING_FACES>;
    row[0] = face;
    are_in_row[0] = true;
    for (var side = 0u; side < 2u; side++) {
        var next = face;
        var is_in_row = true;
        for (var i = 0u; i < SHARING_FACES / 2u; i++) {
            let found = beside[next * HIT_WORDS + FIRST_BESIDE + 2u * axis + side] - HIT_OFFSET;
            is_in_row = is_in_row && found < counts.faces;
            next = select(next, found, is_in_row);
            row[1u + side * (SHARING_FACES / 2u) + i] = next;
            are_in_row[1u + side * (SHARING_FACES / 2u) + i] = is_in_row;
        }
    }
    for (var texel = 0u; texel < FAR_CELLS / 4u; texel++) {
        var x = FarSum();
        var y = FarSum();
        var z = FarSum();
        var w = FarSum();
        for (var i = 0u; i < SHARING_FACES; i++) {
            let packed = textureLoad(far, texel_place(first.x + FAR_TEXELS * row[i] + texel), 0);
            let weight = select(0.0, 1.0, are_in_row[i]);
            x = with_far_light(x, packed.x, weight);
            y = with_far_light(y, packed.y, weight);
            z = with_far_light(z, packed.z, weight);
            w = with_far_light(w, packed.w, weight);
        }
        let means = vec4u(pack_mean(x), pack_mean(y), pack_mean(z), pack_mean(w));
        textureStore(shared_far, texel_place(first.y + FAR_TEXELS * face + texel), means);
    }
    // The light that arrives, with weights that fall towards the ends of the row.
    var own = unpack_face_light(textureLoad(far, texel_place(first.x + last_texel(face)), 0));
    var sum = vec4f(0.0);
    for (var i = 0u; i < SHARING_FACES; i++) {
        let its = unpack_face_light(textureLoad(far, texel_place(first.x + last_texel(row[i])), 0));
        let steps = select((i - 1u) % (SHARING_FACES / 2u) + 1u, 0u, i == 0u);
        let weight = select(0.0, f32(SHARING_FACES / 2u + 1u - steps), are_in_row[i]);
        sum += weight * its.weight * vec4f(its.gathered, 1.0);
    }
    own.gathered = select(own.gathered, sum.rgb / sum.a, sum.a > 0.0);
    textureStore(shared_far, texel_place(first.y + last_texel(face)), pack_face_light(own));
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn rows(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 0u, vec2u(0u, parts.first_far));
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn columns(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 1u, vec2u(parts.first_far, 0u));
    }
}
