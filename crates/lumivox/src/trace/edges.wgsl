// Pixels at half resolution that no traced neighbour fits, traced themselves: thin things and silhouettes.
//
// The upsampling lists them (`upsample.wgsl`); a thread then stands for an element of the list, so that no group waits
// for a few of its threads.

import package::gpu::dispatch::linear_index;
import package::constants::LINEAR_WORKGROUP_SIZE;
import package::trace::diffuse::trace_diffuse;
import package::trace::specular::trace_specular;
import package::trace::view::view;

@group(1) @binding(1) var<storage, read> listed: array<u32>;
@group(1) @binding(2) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(3) var specular_out: texture_storage_2d<rgba16float, write>;

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let index = linear_index(invocation, workgroups);
    if index >= listed[0] {
        return;
    }
    let number = listed[1u + index];
    let pixel = vec2u(number % view.size.x, number / view.size.x);
    let diffuse = trace_diffuse(pixel, view.frame);
    textureStore(irradiance_out, pixel, diffuse.irradiance);
    textureStore(specular_out, pixel, trace_specular(pixel, view.frame, diffuse.samples));
}
