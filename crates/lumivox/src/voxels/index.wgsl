// The index of each voxel's faces, in one buffer.
//
// The buffer has for each word of 32 voxels their bits and the word's rank, then a bit for each
// block of 8 x 8 x 8 voxels, then an entry for each voxel: the index of its first face and, in the
// highest bits, its number of faces. Group 0 is the grid.

import package::constants::{BLOCK_LEVEL, LINEAR_WORKGROUP_SIZE};
import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::voxels::list::{Node, faces_of};
import package::voxels::lookup::{level_first_word, level_words};

@group(1) @binding(0) var<storage, read> occupancy: array<u32>;
@group(1) @binding(1) var<storage, read> ranks: array<u32>;
@group(1) @binding(2) var<storage, read> nodes: array<Node>;
@group(1) @binding(3) var<storage, read> first_faces: array<u32>;
@group(1) @binding(4) var<storage, read_write> index: array<u32>;

// The low bits of an entry, which are the index of the first face.
const FACE_BITS = 26u;

fn first_block() -> u32 {
    return 2u * level_words(0u);
}

fn first_entry() -> u32 {
    return first_block() + level_words(BLOCK_LEVEL);
}

@compute @workgroup_size(LINEAR_WORKGROUP_SIZE)
fn main(
    @builtin(global_invocation_id) invocation: vec3u,
    @builtin(num_workgroups) workgroups: vec3u,
) {
    let i = linear_index(invocation, workgroups);
    let words = level_words(0u);
    if i < words {
        index[2u * i] = occupancy[i];
        index[2u * i + 1u] = ranks[i];
    }
    if i < level_words(BLOCK_LEVEL) {
        // In a grid with fewer levels, all blocks count as occupied.
        var bits = 0xffffffffu;
        if grid.levels > BLOCK_LEVEL {
            bits = occupancy[level_first_word(BLOCK_LEVEL) + i];
        }
        index[first_block() + i] = bits;
    }
    if i < ranks[words] {
        index[first_entry() + i] = first_faces[i] | (faces_of(nodes[i].lobes) << FACE_BITS);
    }
}
