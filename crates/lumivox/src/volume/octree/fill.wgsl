// Bricks from values: a thread a texel copies the values of its cell into the node's bricks.
//
// Two thirds of a brick's texels are its neighbours' (19 of 27). Three ways to find a texel's cell give the same:
// by the ranks of the voxel list (fill_ranked.wgsl), by pointers to the next nodes (fill_pointers.wgsl), and by a
// search from the root (fill_search.wgsl).

import package::gpu::dispatch::linear_index;
import package::grid::grid;
import package::volume::octree::search::{node_parts, octree};
import package::volume::octree::sites::Site;
import package::volume::octree::tree::{brick_origin, node_word, tree, NODE_FIRST_BRICK};
import package::volume::octree::values::unpack_value;
import package::volume::parts::stored_parts;
import package::voxels::list::Node;

// Bindings 0 and 1 belong to the way in which cells are found.
@group(1) @binding(2) var<storage, read> value_starts: array<u32>;
@group(1) @binding(3) var<storage, read> values: array<vec2u>;
@group(1) @binding(4) var<storage, read> nodes: array<Node>;
@group(1) @binding(5) var<storage, read> sites: array<Site>;
// A bit per cell, laid out as the occupancy: the texels of the others stay as they are.
@group(1) @binding(6) var<storage, read> changed: array<u32>;
@group(1) @binding(7) var atlas_out: texture_storage_3d<rgba16float, write>;

const TEXELS: u32 = 27u;

// What a thread fills.
struct Task {
    // False: there is no node in this place, or it leads the way and has no bricks.
    exists: bool,
    slot: u32,
    texel: u32,
}

fn task_of(invocation: vec3u, workgroups: vec3u) -> Task {
    let index = linear_index(invocation, workgroups);
    let slot = index / TEXELS;
    if slot >= tree.slots {
        return Task(false, 0u, 0u);
    }
    let level = sites[slot].level;
    return Task(level > 0u && level <= grid.levels, slot, index % TEXELS);
}

fn texel_offset(texel: u32) -> vec3u {
    return vec3u(texel % 3u, (texel / 3u) % 3u, texel / 9u);
}

// `cell` is a place in the voxel list. Texels without one stay zero, as the texture was made.
fn fill_texel(slot: u32, texel: u32, has_cell: bool, cell: u32) {
    if !has_cell {
        return;
    }
    let code = nodes[cell].morton;
    let word = changed[tree.levels[sites[slot].level - 1u].z + code / 32u];
    if (word & (1u << (code % 32u))) == 0u {
        return;
    }
    let parts = node_parts(slot);
    let first_brick = octree[node_word(slot) + NODE_FIRST_BRICK];
    var there = stored_parts(nodes[cell].lobes);
    var value = value_starts[cell];
    while there != 0u {
        let part = countTrailingZeros(there);
        there &= there - 1u;
        let brick = first_brick + countOneBits(parts & ((1u << part) - 1u));
        let place = brick_origin(brick) + texel_offset(texel);
        textureStore(atlas_out, place, unpack_value(values[value]));
        value++;
    }
}
