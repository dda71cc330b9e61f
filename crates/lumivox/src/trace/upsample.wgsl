// From half to full resolution: each pixel takes the mean of the four traced pixels around it, weighted by how
// well they share its plane. What cones gather is smooth below the size of a voxel, so a traced pixel counts
// less and less up to a voxel off the plane, and less where its normal differs. Where none of the four fits, the pixel
// is listed, to be traced itself (`edges.wgsl`).

import package::grid::grid;
import package::trace::gbuffer::load_surface;
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::trace::view::view;

@group(1) @binding(1) var irradiance_in: texture_2d<f32>;
@group(1) @binding(2) var specular_in: texture_2d<f32>;
@group(1) @binding(3) var irradiance_out: texture_storage_2d<rgba16float, write>;
@group(1) @binding(4) var specular_out: texture_storage_2d<rgba16float, write>;
// How many are listed.
@group(1) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
// From its second element on: their numbers, row by row.
@group(1) @binding(6) var<storage, read_write> listed: array<u32>;

// A neighbour that fits less does not count as one: a third of a voxel off the plane, or turned by 25 degrees.
const FITS: f32 = 0.66;

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
    // Where this frame's traced pixels stand, in the coordinates of the small picture.
    let shift = vec2f(traced_pixel(vec2u(0u)));
    let place = (vec2f(pixel) - shift) / f32(settings.scale);
    let corner = vec2i(floor(place));
    let fraction = place - floor(place);
    let last = vec2i(traced_size()) - 1;

    var irradiance = vec4f(0.0);
    var specular = vec4f(0.0);
    var weights = 0.0;
    var best = 0.0;
    for (var i = 0; i < 4; i++) {
        let offset = vec2i(i & 1, i >> 1);
        let source = vec2u(clamp(corner + offset, vec2i(0), last));
        let other = load_surface(traced_pixel(source));
        if other.depth <= 0.0 {
            continue;
        }
        let bilinear = abs(vec2f(1 - offset) - fraction);
        let off_plane =
            abs(dot(other.position_in_world - surface.position_in_world, surface.geometric_normal));
        let facing = max(dot(other.shading_normal, surface.shading_normal), 0.0);
        let facing_2 = facing * facing;
        // The floors keep a pixel that fits nowhere at the mean of what there is.
        let fit = max(1.0 - off_plane / grid.voxel_size_m, 0.0) * facing_2 * facing_2;
        let weight = (bilinear.x * bilinear.y + 1e-3) * (fit + 1e-4);
        best = max(best, fit);
        irradiance += weight * textureLoad(irradiance_in, source, 0);
        specular += weight * textureLoad(specular_in, source, 0);
        weights += weight;
    }
    if weights > 0.0 {
        irradiance /= weights;
        specular /= weights;
    } else {
        irradiance.a = 1.0;
    }
    textureStore(irradiance_out, pixel, irradiance);
    textureStore(specular_out, pixel, specular);
    if best < FITS && settings.bounces > 0u {
        // In whatever order: each is traced by itself.
        let place = 1u + atomicAdd(&counts[0], 1u);
        if place < arrayLength(&listed) {
            listed[place] = pixel.y * view.size.x + pixel.x;
        }
    }
}
