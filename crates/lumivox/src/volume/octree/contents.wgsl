// What nodes know of themselves and of their neighbours, for the ways of filling bricks that do without ranks.

import package::voxels::lookup::bits_below;

// A node's own cells: the first one's place in the voxel list, and a bit for each of the eight that there is.
@group(1) @binding(0) var<storage, read> contents: array<vec2u>;

// Of a node, its `octant`-th own cell; x: whether there is one, y: its place in the list.
fn own_cell(node: u32, octant: u32) -> vec2u {
    let bits = contents[node].y;
    return vec2u((bits >> octant) & 1u, contents[node].x + bits_below(bits, octant));
}
