//! An octree read back from the GPU.

use std::collections::BTreeMap;

use glam::UVec3;
use half::f16;

use crate::Gi;
use crate::testing::nodes::{NODE_WORDS, NodeAt, walk_nodes};
use crate::testing::{read, read_level};
use crate::volume::CellVolume;
use crate::volume::octree::TreeUniform;
use crate::volume::octree::layout::AtlasSize;
use crate::volume::octree::layout::TreeLayout;
use crate::volume::octree::tree::Tree;

/// A brick: 27 texels, x fastest.
pub(crate) type Brick = [[u16; 4]; 27];

#[derive(Debug, PartialEq)]
pub(crate) struct ReadNode {
    /// The masks of the eight look-ups.
    pub masks: [u32; 8],
    /// The bricks, by part.
    pub bricks: BTreeMap<u32, Brick>,
}

fn tree(gi: &Gi) -> (&Tree, &TreeLayout) {
    match gi.cells() {
        Some(CellVolume::Octree(octree)) => octree.tree(),
        _ => panic!("it is an octree"),
    }
}

/// Reads all nodes; panics if a node is in a wrong place.
pub(crate) fn read_nodes(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    gi: &Gi,
) -> BTreeMap<NodeAt, ReadNode> {
    let (tree, layout) = tree(gi);
    let words: Vec<u32> = read(device, queue, &tree.octree, (tree.octree.size() / 4) as usize);
    let sites: Vec<[u32; 2]> = read(device, queue, &tree.sites, tree.capacity.slots as usize);
    let texels: Vec<[u16; 4]> = read_level(device, queue, tree.atlas.texture(), 0);
    let size = AtlasSize::of(tree.capacity.bricks as u32);
    let tree: TreeUniform = layout.uniform(tree.capacity.slots as u32, tree.capacity.bricks as u32);
    let brick = |number: u32| -> Brick {
        let row = (1 << size.row_bits) - 1;
        let origin = 3 * UVec3::new(
            number & row,
            (number >> size.row_bits) & row,
            number >> (2 * size.row_bits),
        );
        let extent = size.texels();
        std::array::from_fn(|i| {
            let i = i as u32;
            let at = origin + UVec3::new(i % 3, (i / 3) % 3, i / 9);
            texels[((at.z * extent.y + at.y) * extent.x + at.x) as usize]
        })
    };

    let node = |place: u32| {
        let word = (tree.table_words + place * NODE_WORDS) as usize;
        let mask = |i: usize| (words[word + 2 + i / 2] >> (16 * (i % 2))) & 0x1ff;
        let masks: [u32; 8] = std::array::from_fn(mask);
        let all = masks.iter().fold(0, |all, mask| all | mask);
        let first_brick = words[word + 1];
        let parts = (0..9).filter(|part| all & (1 << part) != 0);
        let bricks = parts.enumerate().map(|(i, part)| (part, brick(first_brick + i as u32)));
        ReadNode { masks, bricks: bricks.collect() }
    };
    let places = walk_nodes((&words, tree.table_words), &sites, tree.root_level);
    places.into_iter().map(|(at, place)| (at, node(place))).collect()
}

/// A texel in full floats.
pub(super) fn texel(brick: &Brick, at: UVec3) -> [f32; 4] {
    brick[(at.x + 3 * at.y + 9 * at.z) as usize].map(|bits| f16::from_bits(bits).to_f32())
}
