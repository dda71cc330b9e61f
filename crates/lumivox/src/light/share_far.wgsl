// Averages far light over adjacent faces: over a row of SHARING_FACES faces along one axis of their
// surface, then over rows along the other axis. With turn.wgsl's rays these 7 x 7 faces cover 784
// evenly distributed directions. A row ends where other surface crosses it. The means of rows are
// kept where surface.wgsl will read those of 7 x 7 faces.

import package::constants::{FAR_CELLS, HIT_WORDS, LINEAR_WORKGROUP_SIZE, PATCH_WORDS};
import package::gpu::dispatch::linear_index;
import package::light::turn::{FIRST_BESIDE, HIT_OFFSET, SHARING_FACES};
import package::volume::far_light::{pack_far_light, unpack_far_light, FarLight, NO_FAR_LIGHT};
import package::voxels::counts::ListCounts;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> beside: array<u32>;
@group(1) @binding(2) var<storage, read> far: array<u32>;
@group(1) @binding(3) var<storage, read_write> shared_far: array<u32>;

// The place of far light behind the patches, in a buffer of this length (surface.wgsl).
fn after_patches(length: u32) -> u32 {
    return length / (2u * PATCH_WORDS + FAR_CELLS) * 2u * PATCH_WORDS;
}

// `axis` is 0 or 1, for the two axes along the surface; `first` is where the far light of the first
// face is read, and where it is written.
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
    // FAR_CELLS, but not as a constant (surface.wgsl).
    let cells = min(FAR_CELLS, arrayLength(&far));
    for (var cell = 0u; cell < cells; cell++) {
        // Radiance (rgb) and openness (a), and the number of faces that have some.
        var sum = vec4f(0.0);
        var known = 0.0;
        for (var i = 0u; i < SHARING_FACES; i++) {
            let packed = far[first.x + row[i] * FAR_CELLS + cell];
            let its = unpack_far_light(packed);
            let weight = select(0.0, 1.0, are_in_row[i] && packed != NO_FAR_LIGHT);
            sum += weight * vec4f(its.radiance, its.openness);
            known += weight;
        }
        let mean = sum / max(known, 1.0);
        shared_far[first.y + face * FAR_CELLS + cell] =
            select(NO_FAR_LIGHT, pack_far_light(FarLight(mean.rgb, mean.a)), known > 0.0);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn rows(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 0u, vec2u(0u, after_patches(arrayLength(&shared_far))));
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn columns(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 1u, vec2u(after_patches(arrayLength(&far)), 0u));
    }
}
