// Finds nodes.

import package::constants::OCTREE_STEPS;
import package::volume::octree::tree::{
    all_parts, node_word, octant_of, table_entry, tree, NODE_CHILDREN, NODE_FIRST_BRICK, NODE_MASKS, NONE,
};

// The table, then the nodes (tree.wgsl).
@group(0) @binding(2) var<storage, read> octree: array<u32>;

// The child of a node on the path to a node `below` levels under that child; NONE stays NONE.
fn child_towards(node: u32, node_cell: vec3u, below: u32) -> u32 {
    let children = octree[node_word(node) + NODE_CHILDREN];
    return select(8u * children + octant_of(node_cell >> vec3u(below)), NONE, children == NONE);
}

// The node at a cell of `level`; if there is none, NONE or a place without a node, which has no
// parts. The search descends at most OCTREE_STEPS levels from the table, a constant of the grid. In
// small grids it is zero, and the loop is compiled away.
fn find_node(node_cell: vec3u, level: u32) -> u32 {
    let start_level = max(level, tree.table_level);
    var below = start_level - level;
    var node = octree[table_entry(node_cell >> vec3u(below), start_level)];
    for (var step = 0u; step < OCTREE_STEPS; step++) {
        let is_above = below > 0u && node != NONE;
        below -= u32(is_above);
        node = select(node, child_towards(node, node_cell, below), is_above);
    }
    return node;
}

// The parts that a look-up starting at the `octant`-th cell of a node can contain; none if there is
// no node.
fn node_mask(node: u32, octant: u32) -> u32 {
    let masks = octree[node_word(node) + NODE_MASKS + octant / 2u];
    return (masks >> (16u * (octant & 1u))) & 0x1ffu;
}

// All parts that a node has; none if there is no node.
fn node_parts(node: u32) -> u32 {
    return all_parts(octree[node_word(node) + NODE_MASKS]);
}

// The brick of a part that a node has.
fn brick_of(node: u32, part: u32) -> u32 {
    let before = node_parts(node) & ((1u << part) - 1u);
    return octree[node_word(node) + NODE_FIRST_BRICK] + countOneBits(before);
}
