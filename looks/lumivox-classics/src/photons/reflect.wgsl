// Adds the light that faces reflect of their inserted flux, reflectance / pi * flux / area, to the
// light that already leaves them. The sums are reset to zero for the next light.
//
// A face may consist of layers behind each other, such as a ceiling and a lamp's black panel below
// it. The ceiling's share of the face must not reflect the light that the panel receives: a turned
// Cornell box was 29 % too bright. Such light arrives in front of the face's middle; on a single
// plane it arrives level with the middle. Faces whose light leads by more than LEAD are evaluated
// directly, at their middle. So are faces that fewer than LEAST_TEXELS see: slivers at voxels'
// corners, which get one texel or none.

import package::constants::{LINEAR_WORKGROUP_SIZE, PI};
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::light::lights::{incident_light, is_parallel, lights};
import package::classics::photons::photon_map::{photon_map, Taken};
import package::light::reflected::reflected_from;
import package::light::shadow_map::{shadow_layers, shadow_map_visibility};
import package::voxels::list::Face;

@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read_write> sums: array<Taken>;
@group(1) @binding(3) var<storage, read_write> direct: array<vec4f>;

// 1/32 voxel, in `Taken`'s unit of two voxels: the lead if a layer half a voxel behind is a
// sixteenth of the face.
const LEAD: f32 = 0.015625;

// Two along an edge: as on a whole side in the coarsest allowed map.
const LEAST_TEXELS: f32 = 4.0;

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
    let area_m2 = length(face.vector_area) * grid.voxel_size_m * grid.voxel_size_m;
    let light = lights[photon_map.light];
    let taken = sums[index];
    sums[index] = Taken(0u, 0u);
    let flux = light.intensity * (f32(taken.flux) / photon_map.counts_per_flux);
    var irradiance = flux / area_m2;
    let normal = normalize(face.vector_area);
    let incident = incident_light(light, face.position_in_world);
    let cosine = max(dot(normal, incident.direction), 0.0);
    var texel_m = shadow_layers[photon_map.first_layer].texel_size;
    if !is_parallel(light) {
        texel_m *= incident.distance_m;
    }
    let is_small = area_m2 * cosine < LEAST_TEXELS * texel_m * texel_m;
    if is_small || f32(bitcast<i32>(taken.lead)) > LEAD * f32(taken.flux) {
        irradiance = incident.irradiance * cosine
            * shadow_map_visibility(light, face.position_in_world, normal);
    }
    let leaving = direct[index].rgb + reflected_from(face, cosine) / PI * irradiance;
    direct[index] = vec4f(leaving, 1.0);
}
