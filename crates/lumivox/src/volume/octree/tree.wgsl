// Definitions shared by the kernels that build, fill and sample the octree.
//
// A *node* of level L is a cube of 2^L voxels. Its *brick* stores the values of the 2x2x2 cells of
// level L - 1 in it, and of the next ones along +x, +y and +z: 3x3x3 texels. A trilinear look-up at
// level l reads the cells from floor(texel - 1/2) on, so the brick of the node that contains this
// cell suffices. A node exists if any of its 27 cells is occupied, even if that is a neighbour's.
//
// Nodes are in groups of eight with one child pointer: the children of node n are 8 * children(n) +
// octant, with x in the lowest bit of the octant. Group 0 contains only the root.

import package::constants::{NODE_LEVELS, NODE_WORDS};

struct Tree {
    // The root's level: its cube is the whole grid, rounded up to a power of two.
    root_level: u32,
    // The finest level whose nodes are in the table that searches start from.
    table_level: u32,
    // Words of the table, which comes before the nodes in the buffer.
    table_words: u32,
    // Number of places for nodes, in groups of eight; places without a node have no site.
    slots: u32,
    // One over the size of the atlas in texels.
    inverse_size: vec3f,
    // The atlas has 2^row_bits bricks along x, and as many along y.
    row_bits: u32,
    // Capacity in bricks.
    bricks: u32,
    padding_0: u32,
    padding_1: u32,
    padding_2: u32,
    // For each level, x: the first word of its node bits; y: the first table entry of its nodes; z:
    // the first word of its cells' occupancy bits.
    levels: array<vec4u, NODE_LEVELS>,
}

@group(0) @binding(1) var<uniform> tree: Tree;

// Number of no group and no node: it is the root's, which is never a child and never found.
const NONE: u32 = 0u;

// A node in the buffer: the children's group, the first of its bricks, and eight masks of nine
// bits, two per word, each from the lowest bit of a half on. Mask i contains the parts that a
// look-up starting at the node's i-th cell can contain. All parts of the node (it has a brick for
// each) are in the seven bits above the first mask and the two bits above the second. The root has
// no bricks, so its masks are zero.
const NODE_CHILDREN: u32 = 0u;
const NODE_FIRST_BRICK: u32 = 1u;
const NODE_MASKS: u32 = 2u;

fn node_word(node: u32) -> u32 {
    return tree.table_words + node * NODE_WORDS;
}

// All parts of a node, from the first word of its masks.
fn all_parts(masks: u32) -> u32 {
    return ((masks >> 9u) & 0x7fu) | (((masks >> 25u) & 3u) << 7u);
}

// Puts all parts of a node into the first word of its masks.
fn with_all_parts(masks: u32, parts: u32) -> u32 {
    return masks | ((parts & 0x7fu) << 9u) | ((parts >> 7u) << 25u);
}

// The number of a node among the children of its parent.
fn octant_of(node_cell: vec3u) -> u32 {
    return (node_cell.x & 1u) | ((node_cell.y & 1u) << 1u) | ((node_cell.z & 1u) << 2u);
}

fn corner_of(octant: u32) -> vec3u {
    return vec3u(octant & 1u, (octant >> 1u) & 1u, octant >> 2u);
}

// The index of a node's table entry.
fn table_entry(node_cell: vec3u, level: u32) -> u32 {
    let edge = 1u << (tree.root_level - level);
    return tree.levels[level].y + (node_cell.z * edge + node_cell.y) * edge + node_cell.x;
}

// The texel at which a brick starts in an atlas of 2^row_bits bricks along x and y.
fn brick_place(brick: u32, row_bits: u32) -> vec3u {
    let row_mask = (1u << row_bits) - 1u;
    return 3u * vec3u(brick & row_mask, (brick >> row_bits) & row_mask, brick >> (2u * row_bits));
}

// The texel of the atlas at which a brick starts.
fn brick_origin(brick: u32) -> vec3u {
    return brick_place(brick, tree.row_bits);
}
