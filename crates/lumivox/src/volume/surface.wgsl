// The surfaces that rays meet, in group 0 with the grid and the emitters.

import package::constants::{FAR_CELLS, PATCH_WORDS};

// Index of the voxels' faces (voxels/index.wgsl).
@group(0) @binding(6) var<storage, read> index: array<u32>;
// The faces (patch.wgsl), followed by their far light (far_light.wgsl).
@group(0) @binding(7) var<storage, read> patches: array<vec2u>;

// FAR_CELLS, but not as a constant: drivers unroll loops of known length. With constants a start
// without compiled pipelines takes 11.6 s instead of 9.2 s (lavapipe).
fn far_cells() -> u32 {
    return min(FAR_CELLS, arrayLength(&patches));
}

// A word of far_light.wgsl.
fn far_light_of(face: u32, cell: u32) -> u32 {
    let words = FAR_CELLS / 2u;
    let first = arrayLength(&patches) / (PATCH_WORDS + words) * PATCH_WORDS;
    return patches[first + words * face + cell / 2u][cell % 2u];
}
