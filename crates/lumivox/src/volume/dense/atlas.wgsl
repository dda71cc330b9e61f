// Layout of a cell's parts (parts.wgsl) in the dense volume's texture.
//
// Part p of all cells is a slab of the texture, side by side with the others: three along y, three
// along z. With one texture and a computed address, the tracer loops over the parts that it needs
// instead of branching over nine bindings.

import package::grid::grid;

// The slab of a part, in slabs along each axis of the texture.
fn slab_of(part: u32) -> vec3u {
    return vec3u(0u, part % 3u, part / 3u);
}

// The texel of a part of a cell.
fn part_texel(cell: vec3u, part: u32, level: u32) -> vec3u {
    return cell + slab_of(part) * (grid.dimensions >> vec3u(level));
}
