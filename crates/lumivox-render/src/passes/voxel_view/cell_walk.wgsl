// A walk along a ray from cell to cell (Amanatides and Woo 1987, "A fast voxel traversal algorithm
// for ray tracing"). Lengths are in cells.

struct CellWalk {
    cell: vec3f,
    // The distance at which the ray entered the cell, and the axis of the plane that it crossed.
    distance: f32,
    axis: u32,
    // The distance to the next plane along each axis.
    next: vec3f,
    inverse: vec3f,
    // -1 or 1 along each axis.
    forward: vec3f,
    size: vec3f,
    // False once the walk has left the box.
    is_inside: bool,
}

// A walk into the box from 0 to `size`; `direction` has unit length.
fn walk_into(origin: vec3f, direction: vec3f, size: vec3f) -> CellWalk {
    // A direction parallel to a plane never crosses it: a large number replaces infinity.
    let is_along = abs(direction) < vec3f(1e-12);
    let inverse = select(1.0 / direction, vec3f(1e30), is_along);
    let to_low = -origin * inverse;
    let to_high = (size - origin) * inverse;
    let enter = min(to_low, to_high);
    let leave = max(to_low, to_high);
    let start = max(max(enter.x, enter.y), max(enter.z, 0.0));
    let end = min(leave.x, min(leave.y, leave.z));
    var axis = 2u;
    if enter.x >= start {
        axis = 0u;
    } else if enter.y >= start {
        axis = 1u;
    }
    let forward = select(vec3f(-1.0), vec3f(1.0), direction >= vec3f(0.0));
    let cell = clamp(floor(origin + start * direction), vec3f(0.0), size - 1.0);
    var next = (cell + max(forward, vec3f(0.0)) - origin) * inverse;
    next = select(next, vec3f(1e30), is_along);
    return CellWalk(cell, start, axis, next, inverse, forward, size, end > start);
}

// The axis across which the walk leaves its cell.
fn next_axis(walk: CellWalk) -> u32 {
    if walk.next.x <= walk.next.y && walk.next.x <= walk.next.z {
        return 0u;
    }
    return select(2u, 1u, walk.next.y <= walk.next.z);
}

fn walked_on(from_cell: CellWalk) -> CellWalk {
    var walk = from_cell;
    walk.axis = next_axis(walk);
    walk.distance = walk.next[walk.axis];
    walk.next[walk.axis] += abs(walk.inverse[walk.axis]);
    walk.cell[walk.axis] += walk.forward[walk.axis];
    let at = walk.cell[walk.axis];
    walk.is_inside = walk.is_inside && at >= 0.0 && at < walk.size[walk.axis];
    return walk;
}

// The most cells that a walk can visit.
fn longest_walk(size: vec3f) -> u32 {
    return u32(size.x + size.y + size.z);
}
