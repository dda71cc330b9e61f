// The surfaces that rays meet, in group 0 with the grid and the emitters.

import package::constants::{FAR_CELLS, FAR_TEXELS, PATCH_TEXELS};
import package::gpu::texels::texel_place;

// The first texels of parts of `surface`.
struct Parts {
    first_patch: u32,
    first_far: u32,
}

@group(0) @binding(6) var<uniform> parts: Parts;
// The index of the voxels' faces (voxels/index.wgsl), then PATCH_TEXELS for each face (patch.wgsl),
// then FAR_TEXELS for each face: its far light (far_light.wgsl).
@group(0) @binding(7) var surface: texture_2d<u32>;

fn index_texel(texel: u32) -> vec4u {
    return textureLoad(surface, texel_place(texel), 0);
}

// A texel of a face's patch.
fn patch_texel(face: u32, texel: u32) -> vec4u {
    return textureLoad(surface, texel_place(parts.first_patch + PATCH_TEXELS * face + texel), 0);
}

// FAR_CELLS, but not as a constant: drivers unroll loops of known length. With constants a start
// without compiled pipelines takes 11.6 s instead of 9.2 s (lavapipe).
fn far_cells() -> u32 {
    return min(FAR_CELLS, textureDimensions(surface).x);
}

// Four words of a face's far light (far_light.wgsl).
fn far_texel(face: u32, texel: u32) -> vec4u {
    return textureLoad(surface, texel_place(parts.first_far + FAR_TEXELS * face + texel), 0);
}
