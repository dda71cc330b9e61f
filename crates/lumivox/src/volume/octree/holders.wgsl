// Which nodes have a cell in their bricks.
//
// A cell stands in the brick of the node that it is in and, as a neighbour's, in the bricks of those that end where
// it begins: the nodes before it along each axis along which it is the first of two cells.

import package::volume::octree::tree::corner_of;

// Whether the node that lies back from a cell's own by the `i`-th corner (0 to 7) holds the cell.
fn has_holder(cell: vec3u, i: u32) -> bool {
    let back = corner_of(i);
    return all(back <= ((cell & vec3u(1u)) ^ vec3u(1u))) && all(back <= (cell >> vec3u(1u)));
}
