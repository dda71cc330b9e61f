// All surface, as rays meet it: group 0 next to the grid and the emitters.

import package::volume::far_light::FAR_CELLS;
import package::volume::patch::PATCH_WORDS;

// Where the faces of voxels are (voxels/index.wgsl).
@group(0) @binding(6) var<storage, read> index: array<u32>;
// The faces (patch.wgsl), and behind all of them their light from afar (far_light.wgsl).
@group(0) @binding(7) var<storage, read> patches: array<vec2u>;

// FAR_CELLS, but no constant: drivers unroll loops whose length they know. With constants a start without compiled pipelines takes
// 11.6 s in place of 9.2 (lavapipe).
fn far_cells() -> u32 {
    return min(FAR_CELLS, arrayLength(&patches));
}

// A word of far_light.wgsl.
fn far_light_of(face: u32, cell: u32) -> u32 {
    let words = FAR_CELLS / 2u;
    let first = arrayLength(&patches) / (PATCH_WORDS + words) * PATCH_WORDS;
    return patches[first + words * face + cell / 2u][cell % 2u];
}
