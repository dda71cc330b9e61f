// The values of the cells, from which bricks are filled.
//
// A value is four half floats. Each brick has eight values, for the node's own cells; they are zero
// if a cell does not have the brick's part. So values stay in place as long as the bricks do, and
// the children of a cell, which are the own cells of one node, are adjacent. Bricks are only
// copies, so that no texture is read and written at once.

import package::volume::octree::search::{find_node, node_parts, octree};
import package::volume::octree::tree::{node_word, NODE_FIRST_BRICK};
import package::volume::parts::storable;
import package::voxels::list::Node;
import package::voxels::morton::morton_decode;

// Bindings 0 to 2 are those of the changed cells (volume/changes/cells.wgsl).
@group(1) @binding(3) var<storage, read> nodes: array<Node>;
@group(1) @binding(4) var<storage, read_write> values: array<vec2u>;

fn pack_value(part: vec4f) -> vec2u {
    let value = storable(part);
    return vec2u(pack2x16float(value.xy), pack2x16float(value.zw));
}

fn unpack_value(packed: vec2u) -> vec4f {
    return vec4f(unpack2x16float(packed.x), unpack2x16float(packed.y));
}

// The index of the value of a part of the `octant`-th own cell; the node must have the part.
fn value_place(first_brick: u32, parts: u32, part: u32, octant: u32) -> u32 {
    return 8u * (first_brick + countOneBits(parts & ((1u << part) - 1u))) + octant;
}

// The fields of a node that locate its values.
struct Owner {
    parts: u32,
    first_brick: u32,
}

// The node of a level at a Morton code of that level.
fn owner_at(morton: u32, level: u32) -> Owner {
    let node = find_node(morton_decode(morton), level);
    return Owner(node_parts(node), octree[node_word(node) + NODE_FIRST_BRICK]);
}

// The value of a part of a node's own cell; zero if the node does not have the part.
fn load_value(owner: Owner, octant: u32, part: u32) -> vec4f {
    if ((owner.parts >> part) & 1u) == 0u {
        return vec4f(0.0);
    }
    return unpack_value(values[value_place(owner.first_brick, owner.parts, part, octant)]);
}

// Stores a value; the node must have the part.
fn store_value(owner: Owner, octant: u32, part: u32, value: vec4f) {
    values[value_place(owner.first_brick, owner.parts, part, octant)] = pack_value(value);
}
