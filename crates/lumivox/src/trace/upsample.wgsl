// From half to full resolution: each pixel takes the weighted mean of the four traced pixels around it (`around.wgsl`).
// Where none of the four fits, the pixel is listed, to be traced itself (`edges.wgsl`).

import package::trace::around::{traced_around, FITS};
import package::trace::gbuffer::load_surface;
import package::trace::screen::{settings, traced_share};
import package::trace::view::view;

@group(1) @binding(1) var irradiance_in: texture_2d<f32>;
@group(1) @binding(2) var specular_in: texture_2d<f32>;
@group(1) @binding(3) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(4) var specular_out: texture_storage_2d<rgba16float, write>;
// How many are listed.
@group(1) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
// From its second element on: their numbers, row by row.
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;

@compute @workgroup_size(8, 8)
fn main(@builtin(global_invocation_id) invocation: vec3u) {
    let pixel = invocation.xy;
    if any(pixel >= view.size) {
        return;
    }
    let surface = load_surface(pixel);
    if surface.depth <= 0.0 {
        textureStore(irradiance_out, pixel, vec4f(0.0, 0.0, 0.0, 1.0));
        textureStore(specular_out, pixel, vec4f(0.0));
        return;
    }
    let around = traced_around(pixel, surface);
    var irradiance = vec4f(0.0);
    var specular = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let weight = around.weights[i];
        if weight > 0.0 {
            irradiance += weight * textureLoad(irradiance_in, around.sources[i], 0);
            specular += weight * textureLoad(specular_in, around.sources[i], 0);
            weights += weight;
        }
    }
    specular.a *= traced_share();
    irradiance.a = select(irradiance.a, 1.0, weights <= 0.0);
    textureStore(irradiance_out, pixel, irradiance);
    textureStore(specular_out, pixel, specular);
    if around.best < FITS && settings.bounces > 0u {
        // In whatever order: each is traced by itself.
        let place = 1u + atomicAdd(&counts[0], 1u);
        if place < arrayLength(&listed) {
            listed[place] = pixel.y * view.size.x + pixel.x;
        }
    }
}
