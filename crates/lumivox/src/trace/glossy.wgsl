// Lists the tiles of 8x8 traced pixels with glossy surfaces, which trace reflections
// (`specular.wgsl`); the reflections of other tiles are black.

import package::trace::gbuffer::{load_specular, load_surface};
import package::trace::reflections::{pack_reflections, Reflections};
import package::trace::screen::{settings, traced_pixel, traced_size};
import package::trace::surface::{is_glossy, Specular, Surface};

@group(1) @binding(1) var diffuse_samples: texture_2d<f32>;
@group(1) @binding(2) var specular_out: texture_storage_2d<rgba16float, write>;
// A texture of 1x1 if not needed.
@group(1) @binding(3) var distance_out: texture_storage_2d<r32float, write>;
@group(1) @binding(4) var reflections_out: texture_storage_2d<rgba32uint, write>;
// The number of listed tiles.
@group(1) @binding(5) var<storage, read_write> counts: array<atomic<u32>>;
// Indices of tiles in row-major order, from the second element on; sorted in no way.
@group(1) @binding(6) var<storage, read_write> glossy_tiles: array<u32>;

const TILE: u32 = 8u;

// Whether a pixel traces reflections.
fn reflects(surface: Surface, material: Specular) -> bool {
    return surface.depth > 0.0 && is_glossy(material) && settings.bounces > 0u && settings.specular_share > 0.0;
}

fn tiles_in_row() -> u32 {
    return (traced_size().x + TILE - 1u) / TILE;
}

// The traced pixel of an invocation in the tile of index `tile`.
fn place_in_tile(tile: u32, local: vec2u) -> vec2u {
    return TILE * vec2u(tile % tiles_in_row(), tile / tiles_in_row()) + local;
}

var<workgroup> glossy_pixels: atomic<u32>;

@compute @workgroup_size(TILE, TILE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(workgroup_id) tile: vec3u,
    @builtin(local_invocation_index) local: u32,
) {
    let place = invocation.xy;
    let is_traced = all(place < traced_size());
    if is_traced {
        let pixel = traced_pixel(place);
        if reflects(load_surface(pixel), load_specular(pixel)) {
            atomicAdd(&glossy_pixels, 1u);
        }
    }
    workgroupBarrier();
    if atomicLoad(&glossy_pixels) > 0u {
        if local == 0u {
            glossy_tiles[1u + atomicAdd(&counts[0], 1u)] = tile.y * tiles_in_row() + tile.x;
        }
    } else if is_traced {
        let samples = textureLoad(diffuse_samples, place, 0).r;
        let reflections = Reflections(vec3f(0.0), vec3f(0.0), samples);
        textureStore(specular_out, place, vec4f(0.0, 0.0, 0.0, samples));
        textureStore(distance_out, place, vec4f(0.0));
        textureStore(reflections_out, place, pack_reflections(reflections));
    }
}
