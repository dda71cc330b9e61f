// Defines the nodes that contain a cell in their bricks.
//
// A cell is stored in the brick of its own node and, as a neighbour's cell, in the bricks of the
// nodes that end where it begins: the nodes before its own along each axis along which it is the
// first of two cells.

import package::volume::octree::tree::corner_of;

// Whether the node at the cell's own node minus the `i`-th corner (0 to 7) contains the cell.
fn has_holder(cell: vec3u, i: u32) -> bool {
    let back = corner_of(i);
    return all(back <= ((cell & vec3u(1u)) ^ vec3u(1u))) && all(back <= (cell >> vec3u(1u)));
}
