// Finding nodes.

import package::octree::tree::{
    mask_shift, node_word, octant_of, table_entry, tree, ALL_PARTS, NODE_CHILDREN, NODE_FIRST_BRICK,
    NODE_MASKS, NONE,
};

// The table, then the nodes (tree.wgsl).
@group(0) @binding(2) var<storage, read> octree: array<u32>;

// The node of a level at a cell of that level; NONE if there is none. `start` is an ancestor at `start_level`.
fn descend(node_cell: vec3u, level: u32, start: u32, start_level: u32) -> u32 {
    var node = start;
    var below = start_level - level;
    var is_found = true;
    while below > 0u && is_found {
        below--;
        let children = octree[node_word(node) + NODE_CHILDREN];
        is_found = children != NONE;
        node = 8u * children + octant_of(node_cell >> vec3u(below));
    }
    return select(NONE, node, is_found);
}

// By the table, from a middle level on.
fn find_node(node_cell: vec3u, level: u32) -> u32 {
    let start_level = max(level, tree.table_level);
    let start = octree[table_entry(node_cell >> vec3u(start_level - level), start_level)];
    if start == NONE || start_level == level {
        return start;
    }
    return descend(node_cell, level, start, start_level);
}

// From the root.
fn find_node_from_root(node_cell: vec3u, level: u32) -> u32 {
    return descend(node_cell, level, 0u, tree.root_level);
}

// The parts of a mask of a node.
fn node_mask(node: u32, mask: u32) -> u32 {
    return (octree[node_word(node) + NODE_MASKS + mask / 3u] >> mask_shift(mask)) & 0x1ffu;
}

// The brick of a part that a node has.
fn brick_of(node: u32, part: u32) -> u32 {
    let before = node_mask(node, ALL_PARTS) & ((1u << part) - 1u);
    return octree[node_word(node) + NODE_FIRST_BRICK] + countOneBits(before);
}
