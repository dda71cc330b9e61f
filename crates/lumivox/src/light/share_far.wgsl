// Light from afar, shared among faces beside one another: the mean over a row of 2 REACH + 1 faces along an axis of their surface,
// and then over rows along the other one. With turn.wgsl's rays these 5 x 5 faces look into 400 directions that lie evenly. A row
// ends where other surface crosses it.

import package::cascades::voxel_of;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::volume::beside::{is_parted, patch_of, spot_at, start_of_face, Spot};
import package::volume::far_light::{
    pack_far_light, unpack_far_light, FarLight, FAR_CELLS, NO_FAR_LIGHT,
};
import package::volume::patch::NOTHING;
import package::volume::surface::far_cells;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read> far: array<u32>;
@group(1) @binding(3) var<storage, read_write> shared_far: array<u32>;

const REACH = 2;

// For each cell: sums of radiance (rgb) and openness (a), and the number of faces in them.
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

// The face of the same surface in the next voxel along an axis.
fn next(spot: Spot, axis: u32, step: f32, cascade: u32) -> Spot {
    let plane = patch_of(spot.face);
    let normal = normalize(plane.normal);
    var point = spot.start;
    point[axis] += step;
    point[plane.lobe >> 1u] -= step * normal[axis] / normal[plane.lobe >> 1u];
    var found = spot_at(point, plane.lobe, normal, cascade);
    if found.face != NOTHING && is_parted(spot.start, found.start, normal, cascade) {
        found.face = NOTHING;
    }
    return found;
}

// `along` is 1 or 2: which axis next to that of the lobe.
fn share(face: u32, along: u32) {
    let cells = far_cells();
    for (var i = 0u; i < cells; i++) {
        light[i] = vec4f(0.0);
        known[i] = 0.0;
    }
    let own = voxel_of(morton_decode(faces[face].cell));
    let axis = ((faces[face].lobe >> 1u) + along) % 3u;
    add(face);
    for (var side = -1.0; side < 2.0; side += 2.0) {
        var spot = Spot(face, vec3f(own.voxel) + start_of_face(face));
        for (var i = 0; i < REACH && spot.face != NOTHING; i++) {
            spot = next(spot, axis, side, own.cascade);
            if spot.face != NOTHING {
                add(spot.face);
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
        share(face, 1u);
    }
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn columns(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let face = linear_index(invocation, workgroups);
    if face < counts.faces {
        share(face, 2u);
    }
}
