// The light that faces reflect of the flux that was inserted into them: reflectance / pi * flux / area, on top of
// what they sent out before. The sums are left at zero for the next light.

import package::constants::LINEAR_WORKGROUP_SIZE;
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::light::lights::lights;
import package::light::photon_map::photon_map;
import package::voxels::list::Face;

@group(1) @binding(1) var<storage, read> faces: array<Face>;
@group(1) @binding(2) var<storage, read_write> sums: array<u32>;
@group(1) @binding(3) var<storage, read_write> direct: array<vec4f>;
@group(1) @binding(4) var<storage, read_write> radiance: array<vec4f>;

const PI: f32 = 3.14159265359;

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
    let flux = lights[photon_map.light].intensity
        * (f32(sums[index]) / photon_map.counts_per_flux);
    sums[index] = 0u;
    let leaving = direct[index].rgb + face.reflectance / PI * (flux / area_m2);
    direct[index] = vec4f(leaving, 1.0);
    radiance[index] = vec4f(leaving, 1.0);
}
