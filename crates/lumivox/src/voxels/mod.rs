//! The compact list of occupied voxels: the one thing that all volumes are filled from.
//!
//! Memory layout: a bit per cell of every level, in Morton order, all levels in one buffer; the
//! prefix sum of the bits of its words, so that a cell's rank (its place in the list) is one
//! look-up and one bit count; a [`Node`](NodeRecord) per occupied cell, level after level; a
//! [`Face`](FaceRecord) per voxel and lobe with surface. All of it grows only with the occupied
//! cells, except for the bits: 2 MB at 256³.

mod build;
mod pyramid;

pub(crate) use build::{ListBuilder, Occupied};
pub(crate) use pyramid::{BitLevel, Pyramid, level_first_word};

use crate::gpu::Buffer;
use bytemuck::{Pod, Zeroable};

/// `Node` of `list.wgsl`: an occupied cell of some level.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Eq, Pod, Zeroable)]
pub struct NodeRecord {
    /// The cell's coordinates, interleaved, x in the lowest bit.
    pub morton: u32,
    /// Bits 0 to 5: lobes with coverage here or below; bits 8 to 13: those that are tilted off
    /// their axis.
    pub lobes: u32,
}

/// `Face` of `list.wgsl`: the surface of one lobe in one voxel.
#[repr(C)]
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
pub struct FaceRecord {
    /// Mean position of the surface in the world, m.
    pub position_in_world: [f32; 3],
    /// Index of the voxel in the list.
    pub voxel: u32,
    /// Sum of area times normal in units of a voxel's side, with at most 1 along the lobe's axis.
    pub vector_area: [f32; 3],
    /// +x, -x, +y, -y, +z, -z as 0 to 5.
    pub lobe: u32,
    /// Mean share of the light that enters, which leaves again diffusely.
    pub reflectance: [f32; 3],
    /// Used while voxelizing; zero afterwards.
    pub visible_area: f32,
    /// Mean emitted radiance.
    pub emission: [f32; 3],
    /// Not used.
    pub padding_1: f32,
    /// Means of [`crate::Gloss`], in its order.
    pub gloss: [f32; 3],
    /// Not used.
    pub padding_2: f32,
}

/// The list of occupied voxels of a scene, on the GPU.
#[derive(Debug)]
pub struct VoxelList {
    /// Where each level's nodes start in `nodes`; one entry more than there are levels: the total.
    pub level_starts: Vec<u32>,
    /// How many faces there are.
    pub face_count: u32,
    /// A bit per cell, all levels one after another (`array<u32>`).
    pub occupancy: Buffer,
    /// For each word of `occupancy`, the bits set before it (`array<u32>`).
    pub ranks: Buffer,
    /// `array<Node>`.
    pub nodes: Buffer,
    /// For each voxel, the index of its first face (`array<u32>`); a voxel's faces are in the order
    /// of lobes.
    pub first_faces: Buffer,
    /// `array<Face>`.
    pub faces: Buffer,
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
