// Averages far light over adjacent faces: over a row of SHARING_FACES faces along one axis of their
// surface, then over rows along the other axis. With turn.wgsl's rays these 7 x 7 faces cover 784
// evenly distributed directions. A row ends where other surface crosses it.

import package::constants::{FAR_CELLS, HIT_WORDS, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::light::turn::{FIRST_BESIDE, HIT_OFFSET, SHARING_FACES};
import package::volume::far_light::{pack_far_light, unpack_far_light, FarLight, NO_FAR_LIGHT};
import package::volume::surface::far_cells;
import package::voxels::counts::ListCounts;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> beside: array<u32>;
@group(1) @binding(2) var<storage, read> far: array<u32>;
@group(1) @binding(3) var<storage, read_write> shared_far: array<u32>;

// For each cell: sums of radiance (rgb) and openness (a), and the number of faces that contributed.
var<private> light: array<vec4f, FAR_CELLS>;
var<private> known: array<f32, FAR_CELLS>;

fn add(face: u32) {
    let cells = far_cells();
    for (var i = 0u; i < cells; i++) {
        let packed = far[face * FAR_CELLS + i];
        if packed != NO_FAR_LIGHT {
            let its = unpack_far_light(packed);
            light[i] += vec4f(its.radiance, its.openness);
            known[i] += 1.0;
        }
    }
}

// `axis` is 0 or 1, for the two axes along the surface.
fn share(face: u32, axis: u32) {
    let cells = far_cells();
    for (var i = 0u; i < cells; i++) {
        light[i] = vec4f(0.0);
        known[i] = 0.0;
    }
    add(face);
    for (var side = 0u; side < 2u; side++) {
        var next = face;
        for (var i = 0u; i < SHARING_FACES / 2u && next < counts.faces; i++) {
            next = beside[next * HIT_WORDS + FIRST_BESIDE + 2u * axis + side] - HIT_OFFSET;
            if next < counts.faces {
                add(next);
            }
        }
    }
    for (var i = 0u; i < cells; i++) {
        let mean = light[i] / max(known[i], 1.0);
        shared_far[face * FAR_CELLS + i] =
            select(NO_FAR_LIGHT, pack_far_light(FarLight(mean.rgb, mean.a)), known[i] > 0.0);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn rows(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 0u);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn columns(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 1u);
    }
}
