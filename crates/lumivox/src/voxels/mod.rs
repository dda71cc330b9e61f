//! The compact list of occupied voxels, from which all volumes are filled.
//!
//! Memory layout: a bit per cell of every level, in Morton order, all levels in one buffer; the
//! prefix sum of the bits of its words, so that a cell's rank (its place in the list) is one
//! look-up and one bit count; a [`Node`](NodeRecord) per occupied cell, level after level; a
//! [`Face`](FaceRecord) per voxel, lobe and plane of surface. Everything grows only with the number
//! of occupied cells, except for the bits: 2 MB at 256³.

mod build;
mod pyramid;

pub(crate) use build::{BoundInner, BoundNodes, Cells, ListBuilder, RankedBits};
pub(crate) use pyramid::{BitLevel, BoundPyramid, Pyramid, level_first_word, level_words};

use crate::gpu::{Buffer, Indirect, ShaderLibrary};
use bytemuck::{Pod, Zeroable};

/// Bytes of a block of [`VoxelList::counts`]: the alignment of a uniform binding's offset.
const COUNT_BLOCK_BYTES: u64 = 256;
/// Words of a block of [`VoxelList::counts`].
const COUNT_BLOCK_WORDS: u32 = COUNT_BLOCK_BYTES as u32 / 4;
/// Bytes of [`ListCounts`]; at least as many as [`NodeRange`] has.
pub(crate) const LIST_COUNT_BYTES: u64 = size_of::<ListCounts>() as u64;

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library
        .constant_u32("COUNT_BLOCK_WORDS", COUNT_BLOCK_WORDS)
        .constant_u32("SINGLE_SIDED", FaceRecord::SINGLE_SIDED)
        .constant_u32("HIDDEN", FaceRecord::HIDDEN)
        .constant_u32("PARTED", FaceRecord::PARTED)
        .constant_u32("GLASS", FaceRecord::GLASS)
        .constant_u32("HOLES", FaceRecord::HOLES);
}

/// `ListCounts` of `counts.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct ListCounts {
    pub(crate) fixed_faces: u32,
    pub(crate) faces: u32,
    pub(crate) nodes: u32,
    pub(crate) moving_voxels: u32,
    pub(crate) face_groups: [u32; 3],
    pub(crate) padding: u32,
}

/// `NodeRange` of `counts.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub(crate) struct NodeRange {
    pub(crate) level: u32,
    pub(crate) first: u32,
    pub(crate) count: u32,
    pub(crate) padding: u32,
}

/// Byte offset of a level's [`NodeRange`].
pub(crate) fn level_block(level: u32) -> u64 {
    u64::from(level + 1) * COUNT_BLOCK_BYTES
}

/// Byte offset of the arguments of a dispatch over a level's nodes.
pub(crate) fn level_arguments(level: u32) -> u64 {
    level_block(level) + size_of::<NodeRange>() as u64
}

/// Byte offset of the arguments of a dispatch over all faces.
pub(crate) const FACE_ARGUMENTS: u64 = 16;

/// `Node` of `list.wgsl`: an occupied cell of some level.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct NodeRecord {
    /// The cell's coordinates, interleaved, x in the lowest bit.
    pub morton: u32,
    /// Bits 0 to 5: lobes with coverage here or below; bits 8 to 13: those that are tilted off
    /// their axis; voxels only: bits 14 to 31, the number of faces of each lobe, three bits each.
    pub lobes: u32,
}

impl NodeRecord {
    /// The number of faces of a voxel.
    pub fn faces(&self) -> u32 {
        (0..6).map(|lobe| self.faces_in(lobe)).sum()
    }

    /// The number of faces of one of its lobes.
    pub fn faces_in(&self, lobe: u32) -> u32 {
        self.lobes >> (14 + 3 * lobe) & 7
    }
}

/// `Face` of `list.wgsl`: the surface of one plane in one lobe of a voxel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct FaceRecord {
    /// Mean position of the surface in the world, m.
    pub position_in_world: [f32; 3],
    /// The voxel's Morton code ([`NodeRecord::morton`]).
    pub cell: u32,
    /// Sum of area times normal in units of a voxel's side, with at most 1 along the lobe's axis.
    pub vector_area: [f32; 3],
    /// The lobe: 0 to 5 for +x, -x, +y, -y, +z, -z.
    pub lobe: u32,
    /// Mean share of entering light that is reflected diffusely.
    pub reflectance: [f32; 3],
    /// [`Self::SINGLE_SIDED`], [`Self::HIDDEN`], [`Self::PARTED`], [`Self::GLASS`], and bits 8 to
    /// 15 ([`Self::HOLES`]).
    pub flags: u32,
    /// Mean emitted radiance.
    pub emission: [f32; 3],
    /// The lower half of the mask: a bit for each of 8 x 8 squares of the voxel's side, set if
    /// covered.
    pub mask_low: u32,
    /// Means of [`crate::Gloss`], in its order.
    pub gloss: [f32; 3],
    /// The upper half of the mask.
    pub mask_high: u32,
    /// The covered ranges along u, v, u + v and u - v, a bit for each of 32 parts.
    pub profiles: [u32; 4],
}

impl FaceRecord {
    /// Flag of a face without surface on its back; it blocks rays from behind.
    pub const SINGLE_SIDED: u32 = 1;
    /// Flag of a face that lies inside of other surface: no part is visible, and it does not
    /// gather.
    pub const HIDDEN: u32 = 2;
    /// Flag of a face whose visible part other surface divides, so that some of it is separated
    /// from the point where its light is computed.
    pub const PARTED: u32 = 4;
    /// Flag of a face of transmitting surface, whose [`Self::HOLES`] are those at normal incidence:
    /// towards grazing angles it reflects more.
    pub const GLASS: u32 = 8;
    /// Index of the lowest of eight bits: the share of the covered area that light passes, times
    /// 255.
    pub const HOLES: u32 = 8;
}

/// The list of occupied voxels of a scene, on the GPU.
///
/// Its buffers have spare capacity. The actual numbers are in `counts`, and, once read back, in
/// `level_starts` and `face_count`: exact after [`crate::Gi::voxelize`], a few frames late after
/// [`crate::Gi::frame`].
#[derive(Debug)]
pub struct VoxelList {
    /// The start of each level's nodes in `nodes`, and the total at the end.
    pub level_starts: Vec<u32>,
    /// The number of faces.
    pub face_count: u32,
    /// A bit per cell, all levels one after another (`array<u32>`).
    pub occupancy: Buffer,
    /// For each word of `occupancy`, the number of bits set before it (`array<u32>`).
    pub ranks: Buffer,
    /// All nodes, `array<Node>`.
    pub nodes: Buffer,
    /// For each voxel, the index of its first face (`array<u32>`); a voxel's faces are consecutive,
    /// in the order of lobes.
    pub first_faces: Buffer,
    /// `array<Face>`: the faces of static surface in the order of the voxels, then those of the
    /// voxels that dynamic surface touches, which replace the static ones there.
    pub faces: Buffer,
    /// The counts, laid out as in `package::voxels::counts`.
    pub counts: Buffer,
}

impl VoxelList {
    /// Occupied voxels: the nodes of level 0.
    pub fn voxel_count(&self) -> u32 {
        self.level_nodes(0).len() as u32
    }

    /// The nodes of a level, as a range of the list.
    pub fn level_nodes(&self, level: u32) -> std::ops::Range<u32> {
        self.level_starts[level as usize]..self.level_starts[level as usize + 1]
    }

    /// Capacity of `nodes`, for all levels together.
    pub fn node_capacity(&self) -> u64 {
        self.nodes.size() / size_of::<NodeRecord>() as u64
    }

    /// Capacity of `faces`.
    pub fn face_capacity(&self) -> u64 {
        self.faces.size() / size_of::<FaceRecord>() as u64
    }

    /// Applies read-back `counts`.
    pub(crate) fn know(&mut self, words: &[u32]) {
        (self.level_starts, self.face_count) = Self::counted(words);
    }

    /// `level_starts` and `face_count` of read-back `counts`.
    pub(crate) fn counted(words: &[u32]) -> (Vec<u32>, u32) {
        let counts: ListCounts = bytemuck::pod_read_unaligned(bytemuck::cast_slice(
            &words[..LIST_COUNT_BYTES as usize / 4],
        ));
        let levels = words.chunks_exact(COUNT_BLOCK_WORDS as usize).skip(1);
        let level_starts = levels.map(|level| level[1]).chain([counts.nodes]).collect();
        (level_starts, counts.faces)
    }

    /// Bytes on the GPU, by use.
    pub fn memory(&self) -> Vec<(&'static str, u64)> {
        vec![
            ("voxels: occupancy", self.occupancy.size()),
            ("voxels: ranks", self.ranks.size()),
            ("voxels: nodes", self.nodes.size()),
            ("voxels: first faces", self.first_faces.size()),
            ("voxels: faces", self.faces.size()),
        ]
    }
}

/// Bytes of [`VoxelList::counts`].
pub(crate) fn count_bytes(levels: u32) -> u64 {
    level_block(levels)
}

const _: () = assert!(size_of::<NodeRange>() as u64 + Indirect::STRIDE <= COUNT_BLOCK_BYTES);
const _: () = assert!(size_of::<NodeRange>() as u64 <= LIST_COUNT_BYTES);
