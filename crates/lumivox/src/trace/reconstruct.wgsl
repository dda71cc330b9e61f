// Makes the picture from traced pixels: each pixel is the weighted mean of the four traced pixels
// around it (`around.wgsl`), or its own value at full resolution. If none of the four fits, the
// pixel is listed, to be traced individually (`edges.wgsl`).

import package::trace::around::{traced_around, FITS};
import package::trace::coat::narrowest_alpha;
import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::reflections::{blended, share_of_reflections, unpack_reflections};
import package::trace::screen::{settings, traced_share};
import package::trace::view::view;

@group(1) @binding(1) var guides: texture_2d<u32>;
@group(1) @binding(2) var irradiance_in: texture_2d<f32>;
@group(1) @binding(3) var specular_in: texture_2d<f32>;
// Both with the light of the pixels around, read if settings.shares is set.
@group(1) @binding(4) var shared_irradiance: texture_2d<f32>;
@group(1) @binding(5) var reflections: texture_2d<u32>;
@group(1) @binding(6) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(7) var specular_out: texture_storage_2d<rgba16float, write>;
// The number of listed pixels.
@group(1) @binding(8) var<storage, read_write> counts: array<atomic<u32>>;
// Pixel indices in row-major order, from the second element on.
@group(1) @binding(9) var<storage, read_write> listed: array<u32>;

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
    let around = traced_around(pixel, surface, guides);
    let reflected_share = share_of_reflections(narrowest_alpha(load_specular(pixel)));
    var irradiance = vec4f(0.0);
    var specular = vec4f(0.0);
    var weights = 0.0;
    for (var i = 0; i < 4; i++) {
        let weight = around.weights[i];
        if weight <= 0.0 {
            continue;
        }
        let source = around.sources[i];
        if settings.shares != 0u {
            let filtered = unpack_reflections(textureLoad(reflections, source, 0));
            irradiance += weight * textureLoad(shared_irradiance, source, 0);
            specular += weight * blended(filtered, reflected_share);
        } else {
            irradiance += weight * textureLoad(irradiance_in, source, 0);
            specular += weight * textureLoad(specular_in, source, 0);
        }
        weights += weight;
    }
    specular.a *= traced_share();
    irradiance.a = select(irradiance.a, 1.0, weights <= 0.0);
    textureStore(irradiance_out, pixel, irradiance);
    textureStore(specular_out, pixel, specular);
    if around.best < FITS && settings.bounces > 0u {
        // The order does not matter, since each pixel is traced individually.
        let place = 1u + atomicAdd(&counts[0], 1u);
        if place < arrayLength(&listed) {
            listed[place] = pixel.y * view.size.x + pixel.x;
        }
    }
}
