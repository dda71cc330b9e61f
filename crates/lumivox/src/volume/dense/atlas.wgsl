// Where the parts of a cell stand in the volume's one texture.
//
// A cell with six lobes has nine parts of four half floats. For each axis: 0, the tilt: the two components
// across the axis of the vector area of the positive lobe (xy) and of the negative one (zw), in cyclic order;
// 1 and 2, the positive and the negative lobe: radiance premultiplied by opacity, and opacity, which is the
// vector area's component along the axis. Part p of all cells is a slab of the texture, side by side with the
// others: three along y, three along z. One texture with a computed address lets the tracer loop over the
// parts that it needs instead of branching over nine bindings.

import package::grid::grid;

const PARTS: u32 = 9u;
const TILT: u32 = 0u;
const POSITIVE: u32 = 1u;
const NEGATIVE: u32 = 2u;

fn part_of(axis: u32, kind: u32) -> u32 {
    return 3u * axis + kind;
}

// Slabs along each axis of the texture.
fn slab_of(part: u32) -> vec3u {
    return vec3u(0u, part % 3u, part / 3u);
}

// The texel of a part of a cell.
fn part_texel(cell: vec3u, part: u32, level: u32) -> vec3u {
    return cell + slab_of(part) * (grid.dimensions >> vec3u(level));
}
