//! Layout of the octree's buffers: the Rust side of `tree.wgsl`.

use bytemuck::{Pod, Zeroable};
use glam::UVec3;

use crate::Grid;
use crate::voxels::{BitLevel, level_first_word};

/// Upper bound of the number of levels of nodes and cells; 1024 voxels have levels 0 to 10.
pub(crate) const NODE_LEVELS: usize = 12;
/// Words of a node in the buffer (`tree.wgsl`).
pub(crate) const NODE_WORDS: u32 = 6;
/// Nodes along an edge of the finest level of the table: a quarter of a million entries in that
/// level.
const TABLE_EDGE: u32 = 64;

/// `Tree` of `tree.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct TreeUniform {
    pub(crate) root_level: u32,
    pub(crate) table_level: u32,
    pub(crate) table_words: u32,
    pub(crate) slots: u32,
    pub(crate) inverse_size: [f32; 3],
    pub(crate) row_bits: u32,
    pub(crate) bricks: u32,
    pub(crate) padding: [u32; 3],
    pub(crate) levels: [[u32; 4]; NODE_LEVELS],
}

/// The part of the layout that depends only on the grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct TreeLayout {
    pub root_level: u32,
    table_level: u32,
    table_words: u32,
    levels: [[u32; 4]; NODE_LEVELS],
}

impl TreeLayout {
    pub fn new(grid: &Grid) -> Self {
        let edge = grid.morton_edge(0);
        let root_level = edge.ilog2();
        let table_level = (edge / TABLE_EDGE).max(2).ilog2();
        let mut levels = [[0; 4]; NODE_LEVELS];
        let mut table_words = 0;
        let before = level_first_word(grid, 1);
        for level in 1..=root_level {
            let words = &mut levels[level as usize];
            words[0] = (level_first_word(grid, level) - before) as u32;
            // Nodes above the coarsest cells only lead to finer ones; no search looks for them.
            if level >= table_level && level <= grid.levels {
                words[1] = table_words;
                table_words += (edge >> level).pow(3);
            }
        }
        for level in 0..grid.levels {
            levels[level as usize][2] = level_first_word(grid, level) as u32;
        }
        Self { root_level, table_level, table_words, levels }
    }

    /// Number of levels from the table down to the finest nodes.
    pub fn steps(&self) -> u32 {
        self.table_level - 1
    }

    /// Number of words of node bits of the levels below the root's.
    pub fn bit_words(&self) -> u32 {
        self.levels[self.root_level as usize][0]
    }

    /// The place of a level's node bits.
    pub fn bits(&self, level: u32) -> BitLevel {
        let cells = 1 << (3 * (self.root_level - level));
        BitLevel { first_word: self.levels[level as usize][0], words: (cells / 32).max(1) }
    }

    /// Number of words of the table and of `slots` places for nodes.
    pub fn words(&self, slots: u64) -> u64 {
        u64::from(self.table_words) + slots * u64::from(NODE_WORDS)
    }

    /// The uniform of an octree with these capacities.
    pub fn uniform(&self, slots: u32, bricks: u32) -> TreeUniform {
        let atlas = AtlasSize::of(bricks);
        TreeUniform {
            root_level: self.root_level,
            table_level: self.table_level,
            table_words: self.table_words,
            slots,
            inverse_size: atlas.texels().as_vec3().recip().to_array(),
            row_bits: atlas.row_bits,
            bricks,
            padding: [0; 3],
            levels: self.levels,
        }
    }
}

/// Arrangement of the bricks in the atlas: rows and slices are powers of two, so that a brick's
/// place is bits of its number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct AtlasSize {
    pub row_bits: u32,
    slices: u32,
}

impl AtlasSize {
    /// About as many slices as bricks in a row.
    pub fn of(bricks: u32) -> Self {
        let bricks = bricks.max(1);
        let row_bits = bricks.ilog2().div_ceil(3);
        Self { row_bits, slices: bricks.div_ceil(1 << (2 * row_bits)) }
    }

    pub fn texels(self) -> UVec3 {
        let row = 1 << self.row_bits;
        3 * UVec3::new(row, row, self.slices)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn atlas_sizes_fit_their_bricks_tightly() {
        for bricks in [1, 2, 7, 8, 9, 511, 512, 513, 50_000, 3_000_000, 100_000_000] {
            let size = AtlasSize::of(bricks);
            let room = (size.texels() / 3).as_u64vec3().element_product();
            let slice = 1_u64 << (2 * size.row_bits);
            assert!(room >= u64::from(bricks) && room < u64::from(bricks) + slice, "{bricks}");
            assert!(slice as f64 <= 4.0 * f64::from(bricks).powf(2.0 / 3.0), "{bricks}: {slice}");
        }
        // WebGPU's default limit for the edge of a 3D texture.
        assert!(AtlasSize::of(100_000_000).texels().max_element() <= 2048);
    }
}
