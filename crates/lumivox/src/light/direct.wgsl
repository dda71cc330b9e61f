// Direct light and emission into the voxels: the radiance that each face sends out before any
// bounce.
//
// A face's radiance is the same in all directions: L = Le + sum over lights of irradiance times
// reflected share (reflected.wgsl) / pi.

import package::cascades::cascade_of;
import package::constants::{LINEAR_WORKGROUP_SIZE, PI};
import package::gpu::dispatch::linear_index;
import package::light::lights::{incident_light, light_globals, lights, Light};
import package::light::reflected::reflected_from;
import package::light::visibility::light_visibility_from;
import package::voxels::counts::ListCounts;
import package::voxels::list::Face;
import package::voxels::morton::morton_decode;

@group(1) @binding(0) var<uniform> counts: ListCounts;
@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read_write> direct: array<vec4f>;

// Radiance that the middle of a face reflects of one light.
fn leaving_of(light: Light, face: Face, normal: vec3f) -> vec3f {
    let incident = incident_light(light, face.position_in_world);
    let cosine = dot(normal, incident.direction);
    if cosine <= 0.0 || all(incident.irradiance <= vec3f(0.0)) {
        return vec3f(0.0);
    }
    let level = cascade_of(morton_decode(face.cell));
    let irradiance = incident.irradiance * cosine
        * light_visibility_from(light, incident, face.position_in_world, normal, level);
    return reflected_from(face, cosine) / PI * irradiance;
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
    let normal = normalize(face.vector_area);
    var leaving = face.emission;
    for (var i = 0u; i < light_globals.light_count; i++) {
        leaving += leaving_of(lights[i], face, normal);
    }
    direct[index] = vec4f(leaving, 1.0);
}
