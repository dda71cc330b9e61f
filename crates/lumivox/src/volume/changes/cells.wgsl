// The changed cells of a level, over which the kernels that write the volume run
// (volume/changes/mod.rs).

import package::volume::changes::list::{ChangedCell, NOTHING};

struct LevelWords {
    level: u32,
    // Range of words of the level's bits.
    first_word: u32,
    end_word: u32,
}

@group(1) @binding(0) var<uniform> level_words: LevelWords;
@group(1) @binding(1) var<storage, read> changed_ranks: array<u32>;
@group(1) @binding(2) var<storage, read> changed_cells: array<ChangedCell>;

// The cell with this number; NOTHING after the last one.
fn changed_cell(index: u32) -> ChangedCell {
    let place = changed_ranks[level_words.first_word] + index;
    if place >= changed_ranks[level_words.end_word] {
        return ChangedCell(NOTHING, NOTHING);
    }
    return changed_cells[place];
}
