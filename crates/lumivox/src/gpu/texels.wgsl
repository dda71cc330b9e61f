// Textures that are lists of texels of four words (texels.rs).

import package::constants::TEXEL_COLUMNS;

// The place of a texel.
fn texel_place(index: u32) -> vec2u {
    return vec2u(index % TEXEL_COLUMNS, index / TEXEL_COLUMNS);
}
