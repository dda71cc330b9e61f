// The index of each voxel's faces, in texels of four words: the first part of volume/surface.wgsl.
//
// It has a texel for each block of 4 x 4 x 4 voxels, which are two words of bits: their bits and
// ranks (bits, rank, bits, rank), or in an empty block (0, edge of the empty space, 0, 0). Then it
// has an entry for each voxel: the index of its first face and, in the highest bits, its number of
// faces. Group 0 is the grid.

import package::constants::{BLOCK_LEVEL, CASCADES, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::gpu::texels::texel_place;
import package::grid::grid;
import package::voxels::list::{Node, faces_of};
import package::voxels::lookup::{level_first_word, level_words};

@group(1) @binding(0) var<storage, read> occupancy: array<u32>;
@group(1) @binding(1) var<storage, read> ranks: array<u32>;
@group(1) @binding(2) var<storage, read> nodes: array<Node>;
@group(1) @binding(3) var<storage, read> first_faces: array<u32>;
@group(1) @binding(4) var surface: texture_storage_2d<rgba32uint, write>;

// The low bits of an entry, which are the index of the first face.
const FACE_BITS = 26u;

// The first texel of the entries.
fn first_entry() -> u32 {
    return (level_words(0u) + 1u) / 2u;
}

fn bits_and_rank(word: u32) -> vec2u {
    return select(vec2u(0u), vec2u(occupancy[word], ranks[word]), word < level_words(0u));
}

// The edge of the largest empty block around an empty one of 4 x 4 x 4: up to 8 with cascades, as
// larger blocks wrap around in storage, otherwise up to 32.
fn empty_edge(pair: u32) -> u32 {
    if grid.levels <= BLOCK_LEVEL {
        return 4u;
    }
    // A bit for each block of 8 x 8 x 8. A byte of bits is a block of 16 x 16 x 16, and two words
    // are one of 32 x 32 x 32.
    let block = pair / 8u;
    let first = level_first_word(BLOCK_LEVEL);
    let word = block / 32u;
    let bits = occupancy[first + word];
    if (bits & (1u << (block % 32u))) != 0u {
        return 4u;
    }
    if CASCADES > 0u || ((bits >> (block & 24u)) & 0xffu) != 0u {
        return 8u;
    }
    let is_pair = level_words(BLOCK_LEVEL) > 1u;
    return select(16u, 32u, is_pair && (bits | occupancy[first + (word ^ 1u)]) == 0u);
}

fn entry_of(voxel: u32) -> u32 {
    return first_faces[voxel] | (faces_of(nodes[voxel].lobes) << FACE_BITS);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let i = linear_index(invocation, workgroups);
    let four = 4u * i + vec4u(0u, 1u, 2u, 3u);
    if i < first_entry() {
        var texel = vec4u(bits_and_rank(2u * i), bits_and_rank(2u * i + 1u));
        if (texel.x | texel.z) == 0u {
            texel = vec4u(0u, empty_edge(i), 0u, 0u);
        }
        textureStore(surface, texel_place(i), texel);
    }
    if four.x < ranks[level_words(0u)] {
        // No ray reads entries past the last.
        let texel = vec4u(entry_of(four.x), entry_of(four.y), entry_of(four.z), entry_of(four.w));
        textureStore(surface, texel_place(first_entry() + i), texel);
    }
}
