// Lists the traced pixels with a glossy surface, which trace reflections (`specular.wgsl`); the
// reflections of all others are black.

import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::reflections::{pack_reflections, Reflections};
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::trace::surface::is_glossy;

@group(1) @binding(1) var diffuse_samples: texture_2d<f32>;
@group(1) @binding(2) var specular_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(3) var distance_out: texture_storage_2d<r32float, write>;
@group(1) @binding(4) var reflections_out: texture_storage_2d<rgba32uint, write>;
// The number of listed pixels.
@group(1) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
// Indices of traced pixels in row-major order, from the second element on; sorted in no way.
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;

// The workgroup's number of glossy pixels, and the first one's place in the list.
var<workgroup> count: atomic<u32>;
var<workgroup> first: u32;

@compute @workgroup_size(8, 8)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let place = invocation.xy;
    let is_traced = all(place < traced_size());
    var is_listed = false;
    if is_traced {
        let pixel = traced_pixel(place);
        is_listed = load_surface(pixel).depth > 0.0 && is_glossy(load_specular(pixel))
            && settings.bounces > 0u && settings.specular_share > 0.0;
    }
    var own = 0u;
    if is_listed {
        own = atomicAdd(&count, 1u);
    }
    workgroupBarrier();
    if local == 0u {
        first = 1u + atomicAdd(&counts[0], atomicLoad(&count));
    }
    workgroupBarrier();
    if is_listed && first + own < arrayLength(&listed) {
        listed[first + own] = place.y * traced_size().x + place.x;
    } else if is_traced {
        let samples = textureLoad(diffuse_samples, place, 0).r;
        textureStore(specular_out, place, vec4f(0.0, 0.0, 0.0, samples));
        textureStore(distance_out, place, vec4f(0.0));
        textureStore(reflections_out, place, pack_reflections(Reflections(vec3f(0.0), vec3f(0.0), samples)));
    }
}
