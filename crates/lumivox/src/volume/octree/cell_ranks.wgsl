// A cell's index in the voxel list, from the occupancy bits and their ranks.

import package::grid::grid;
import package::volume::octree::tree::tree;
import package::voxels::lookup::bits_below;
import package::voxels::morton::morton_encode;

@group(1) @binding(0) var<storage, read> occupancy: array<u32>;
@group(1) @binding(1) var<storage, read> ranks: array<u32>;

const NO_CELL: u32 = 0xffffffffu;

fn cell_rank(cell: vec3u, level: u32) -> u32 {
    if any(cell >= (grid.dimensions >> vec3u(level))) {
        return NO_CELL;
    }
    let code = morton_encode(cell);
    let word = tree.levels[level].z + code / 32u;
    let bits = occupancy[word];
    if (bits & (1u << (code % 32u))) == 0u {
        return NO_CELL;
    }
    return ranks[word] + bits_below(bits, code % 32u);
}
