// Which nodes of a level have changed, and are written (volume/changes/mod.rs).

import package::volume::level_range::node_range;

// A bit per cell, laid out as the list's occupancy.
@group(1) @binding(2) var<storage, read> changed: array<u32>;

fn has_changed(morton: u32) -> bool {
    return (changed[node_range.first_word + morton / 32u] & (1u << (morton % 32u))) != 0u;
}
