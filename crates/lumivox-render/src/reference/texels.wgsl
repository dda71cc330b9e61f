// Textures from the atlas, filtered in the shader: colours are converted to linear before they are
// mixed.
//
// Only the finest level is read: the mean over a pixel's samples does the work of the rasterizer's
// mips.

import package::constants::{TILE_CLAMP, TILE_COLOR, TILE_MIRROR, TILE_NEAREST, TILE_PRESENT};
import package::render::scene::material::texcoord_at;
import package::render::reference::world::{atlas, materials, Tile};

fn wrapped(at: i32, size: i32, bits: u32) -> i32 {
    if (bits & TILE_CLAMP) != 0u {
        return clamp(at, 0, size - 1);
    }
    if (bits & TILE_MIRROR) != 0u {
        let turn = ((at % (2 * size)) + 2 * size) % (2 * size);
        return min(turn, 2 * size - 1 - turn);
    }
    return ((at % size) + size) % size;
}

fn linear_from_srgb(encoded: vec3f) -> vec3f {
    // IEC 61966-2-1.
    return select(
        pow((encoded + 0.055) / 1.055, vec3f(2.4)), encoded / 12.92, encoded <= vec3f(0.04045));
}

fn texel(tile: Tile, at: vec2i) -> vec4f {
    // The bits of the second axis are above those of the first.
    let place = vec2i(
        wrapped(at.x, i32(tile.size.x), tile.bits), wrapped(at.y, i32(tile.size.y), tile.bits >> 2u));
    let raw = textureLoad(atlas, vec2i(tile.origin) + place, tile.layer, 0);
    return vec4f(select(raw.rgb, linear_from_srgb(raw.rgb), (tile.bits & TILE_COLOR) != 0u), raw.a);
}

// One of a material's textures at a vertex's coordinates; white if there is none.
fn sample_texture(material: u32, which: u32, texcoords: vec4f) -> vec4f {
    let tile = materials[material].tiles[which];
    if (tile.bits & TILE_PRESENT) == 0u {
        return vec4f(1.0);
    }
    let at = texcoord_at(materials[material].shown.places[which], texcoords) * vec2f(tile.size);
    if (tile.bits & TILE_NEAREST) != 0u {
        return texel(tile, vec2i(floor(at)));
    }
    let low = floor(at - 0.5);
    let share = at - 0.5 - low;
    let corner = vec2i(low);
    return mix(
        mix(texel(tile, corner), texel(tile, corner + vec2i(1, 0)), share.x),
        mix(texel(tile, corner + vec2i(0, 1)), texel(tile, corner + vec2i(1, 1)), share.x),
        share.y,
    );
}
