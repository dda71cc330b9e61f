// The place of a cell's bit in the occupancy bits, and its rank: its place in the list of nodes.
//
// The bits of all levels are consecutive, level 0 first, each level in Morton order over the
// enclosing power-of-two cube and starting at a word boundary. A cell's rank is `ranks[word] +
// bits_below(occupancy[word], bit)`; it names a node only if the bit is set.

import package::grid::grid;

// The edge of the enclosing cube of level 0.
fn morton_edge() -> u32 {
    let longest = max(grid.dimensions.x, max(grid.dimensions.y, grid.dimensions.z));
    return 1u << (32u - countLeadingZeros(longest - 1u));
}

// Number of words of a level, of 32 cells each.
fn level_words(level: u32) -> u32 {
    let edge = morton_edge() >> level;
    return max(edge * edge * edge / 32u, 1u);
}

fn level_first_word(level: u32) -> u32 {
    var first = 0u;
    for (var finer = 0u; finer < level; finer++) {
        first += level_words(finer);
    }
    return first;
}

// Number of set bits below the given one (0 to 31).
fn bits_below(bits: u32, bit: u32) -> u32 {
    return countOneBits(bits & ((1u << bit) - 1u));
}
