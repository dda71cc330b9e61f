// The parts of a cell.
//
// A cell with six lobes has up to nine parts of four half floats. For each axis: 0, the tilt: the
// two components across the axis of the vector area of the positive lobe (xy) and of the negative
// one (zw), in cyclic order; 1 and 2, the positive and the negative lobe: radiance premultiplied by
// opacity, and opacity, which is the vector area's component along the axis. An isotropic cell has
// the one part 0: radiance premultiplied, and opacity.

import package::constants::{CELL_PARTS, ISOTROPIC, LARGEST_HALF};

const TILT: u32 = 0u;
const POSITIVE: u32 = 1u;
const NEGATIVE: u32 = 2u;

// A part, clamped to half floats: brighter values would become infinite, and each bounce would
// spread them.
fn storable(part: vec4f) -> vec4f {
    return min(part, vec4f(LARGEST_HALF));
}

fn part_of(axis: u32, kind: u32) -> u32 {
    return 3u * axis + kind;
}

// The parts of a node of the voxel list: bit 3 * axis for a tilt, the next two for the positive and
// the negative lobe.
fn parts_of_lobes(lobes: u32) -> u32 {
    var parts = 0u;
    for (var axis = 0u; axis < 3u; axis++) {
        let sides = (lobes >> (2u * axis)) & 3u;
        let tilted = (lobes >> (8u + 2u * axis)) & 3u;
        parts |= ((sides << 1u) | select(0u, 1u, tilted != 0u)) << (3u * axis);
    }
    return parts;
}

// The parts of a node that an octree stores.
fn stored_parts(lobes: u32) -> u32 {
    return select(parts_of_lobes(lobes), 1u, ISOTROPIC != 0u);
}
