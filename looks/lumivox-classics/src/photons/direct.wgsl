// The light that leaves faces before photons arrive: emission, and reflected light of lights
// without maps.

import package::constants::{LINEAR_WORKGROUP_SIZE, SHADOW_MAP};
import package::gpu::dispatch::linear_index;
import package::light::direct::leaving_of;
import package::light::lights::{light_globals, lights};
import package::voxels::list::Face;

@group(1) @binding(0) var<storage, read> faces: array<Face>;
@group(1) @binding(1) var<storage, read_write> direct: array<vec4f>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= arrayLength(&direct) {
        return;
    }
    let face = faces[index];
    let normal = normalize(face.vector_area);
    var leaving = face.emission;
    for (var i = 0u; i < light_globals.light_count; i++) {
        if lights[i].shadow != SHADOW_MAP {
            leaving += leaving_of(lights[i], face, normal);
        }
    }
    direct[index] = vec4f(leaving, 1.0);
}
