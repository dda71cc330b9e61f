//! A voxel list read back, and checks for every list.

use std::collections::BTreeSet;
use std::sync::Arc;

use bytemuck::Pod;
use glam::{UVec3, Vec3};
use lumivox::gpu::{Pipelines, Timing, read_buffer};
use lumivox::hooks::Voxelization;
use lumivox::voxels::{FaceRecord, NodeRecord};
use lumivox::{Geometry, Gi, GiConfig, Grid, VoxelizeStats};

#[derive(Debug)]
pub struct ReadList {
    pub grid: Grid,
    pub level_starts: Vec<u32>,
    pub occupancy: Vec<u32>,
    pub ranks: Vec<u32>,
    pub nodes: Vec<NodeRecord>,
    pub first_faces: Vec<u32>,
    pub faces: Vec<FaceRecord>,
    pub stats: VoxelizeStats,
}

/// A device, and a voxelizer; `None` is the exact one.
pub struct Lab {
    pub device: Pipelines,
    pub queue: wgpu::Queue,
    voxelizer: Option<Arc<dyn Voxelization>>,
}

impl Lab {
    pub fn new() -> Self {
        Self::by(None)
    }

    /// A lab with another voxelizer, or the exact one.
    pub fn by(voxelizer: Option<Arc<dyn Voxelization>>) -> Self {
        let (device, queue) = crate::common::device();
        Self { device, queue, voxelizer }
    }

    /// A `Gi` without voxels.
    pub fn gi(&self, grid: &Grid) -> Gi {
        let config = GiConfig { voxelizer: self.voxelizer.clone(), ..GiConfig::new(*grid) };
        Gi::with_pipelines(&self.device, &self.queue, config).expect("a device")
    }

    /// Voxelizes, reads everything back and checks what holds for every list.
    pub fn voxelize(&self, grid: &Grid, geometry: &Geometry) -> ReadList {
        self.voxelize_into(geometry, &mut self.gi(grid))
    }

    /// As [`Self::voxelize`], with the static draws that `gi` has kept.
    pub fn voxelize_into(&self, geometry: &Geometry, gi: &mut Gi) -> ReadList {
        let voxelizing = gi.voxelize_dynamic(geometry, Timing::Off);
        let stats = pollster::block_on(voxelizing).expect("the geometry is voxelized").stats;
        let (grid, list) = (gi.grid(), gi.voxels().expect("there is a list"));
        let nodes: Vec<NodeRecord> =
            self.read(&list.nodes, u64::from(list.level_starts[grid.levels as usize]));
        let first_faces: Vec<u32> = self.read(&list.first_faces, u64::from(list.voxel_count()));
        let places: Vec<FaceRecord> = self.read(&list.faces, u64::from(list.face_count));
        // In the order of voxels, independent of where faces are stored.
        let faces = nodes.iter().zip(&first_faces).flat_map(|(node, &first)| {
            let count = node.faces();
            places[first as usize..(first + count) as usize].to_vec()
        });
        let read = ReadList {
            grid: *grid,
            occupancy: self.read(&list.occupancy, list.occupancy.size() / 4),
            ranks: self.read(&list.ranks, list.ranks.size() / 4),
            faces: faces.collect(),
            nodes,
            first_faces,
            level_starts: list.level_starts.clone(),
            stats,
        };
        read.check();
        read
    }

    fn read<T: Pod>(&self, buffer: &wgpu::Buffer, count: u64) -> Vec<T> {
        let bytes = count * size_of::<T>() as u64;
        if bytes == 0 {
            return Vec::new();
        }
        pollster::block_on(read_buffer(&self.device, &self.queue, buffer, 0..bytes))
            .expect("the buffer is read")
    }
}

fn gather_bits(code: u32) -> u32 {
    (0..10).map(|i| ((code >> (3 * i)) & 1) << i).sum()
}

pub fn morton_decode(code: u32) -> UVec3 {
    UVec3::new(gather_bits(code), gather_bits(code >> 1), gather_bits(code >> 2))
}

impl ReadList {
    pub fn voxel(&self, index: u32) -> [u32; 3] {
        morton_decode(self.nodes[index as usize].morton).to_array()
    }

    pub fn voxels(&self) -> BTreeSet<[u32; 3]> {
        (0..self.level_starts[1]).map(|index| self.voxel(index)).collect()
    }

    /// The sum of the faces' vector areas.
    pub fn total_area(&self) -> glam::DVec3 {
        self.faces.iter().map(|face| Vec3::from(face.vector_area).as_dvec3()).sum()
    }

    /// The sum of the areas along the lobes.
    pub fn total_along(&self) -> f64 {
        self.faces.iter().map(|face| f64::from(along(face))).sum()
    }

    /// Bits of everything, to compare two runs.
    pub fn bits(&self) -> [&[u32]; 5] {
        [
            &self.occupancy,
            &self.ranks,
            bytemuck::cast_slice(&self.nodes),
            &self.first_faces,
            bytemuck::cast_slice(&self.faces),
        ]
    }

    /// The pyramid is the OR of children, ranks are bit counts, nodes are in Morton order, inner
    /// lobes are those of the children, faces belong to their voxels.
    fn check(&self) {
        let levels = self.grid.levels;
        let mut words = Vec::new();
        let mut first = 0;
        for level in 0..levels {
            let count = ((self.grid.morton_edge(level) as usize).pow(3) / 32).max(1);
            words.push(first..first + count);
            first += count;
        }
        let bit = |level: u32, code: usize| {
            (self.occupancy[words[level as usize].start + code / 32] >> (code % 32)) & 1
        };
        for level in 1..levels {
            for code in 0..(self.grid.morton_edge(level) as usize).pow(3) {
                let any = (0..8).fold(0, |any, child| any | bit(level - 1, code * 8 + child));
                assert_eq!(bit(level, code), any, "cell {code} of level {level}");
            }
        }
        let mut rank = 0;
        for (word, bits) in self.occupancy[..first].iter().enumerate() {
            assert_eq!(self.ranks[word], rank, "rank of word {word}");
            rank += bits.count_ones();
        }
        assert_eq!(self.level_starts[levels as usize], rank);
        assert_eq!(self.nodes.len() as u32, rank);
        for level in 0..levels {
            let range = &words[level as usize];
            assert_eq!(self.level_starts[level as usize], self.ranks[range.start]);
            let set = range.clone().flat_map(|word| {
                let bits = self.occupancy[word];
                let base = (word - range.start) as u32 * 32;
                (0..32).filter(move |i| (bits >> i) & 1 == 1).map(move |i| base + i)
            });
            let starts = self.level_starts[level as usize]..self.level_starts[level as usize + 1];
            let nodes = &self.nodes[starts.start as usize..starts.end as usize];
            assert!(set.eq(nodes.iter().map(|node| node.morton)), "nodes of level {level}");
        }
        self.check_lobes();
    }

    fn check_lobes(&self) {
        for level in 1..self.grid.levels as usize {
            let children = self.level_starts[level - 1]..self.level_starts[level];
            let mut lobes = std::collections::HashMap::new();
            for child in &self.nodes[children.start as usize..children.end as usize] {
                // Without the number of faces, which only voxels have.
                *lobes.entry(child.morton / 8).or_insert(0) |= child.lobes & 0x3fff;
            }
            let own = self.level_starts[level]..self.level_starts[level + 1];
            for node in &self.nodes[own.start as usize..own.end as usize] {
                assert_eq!(node.lobes, lobes[&node.morton], "lobes of a node of level {level}");
            }
        }
        let mut face = 0;
        for voxel in 0..self.level_starts[1] {
            let node = self.nodes[voxel as usize];
            let mut tilted = 0;
            for lobe in 0..6 {
                let count = node.faces_in(lobe);
                assert_eq!(count > 0, (node.lobes >> lobe) & 1 == 1, "lobe {lobe} of {voxel}");
                for _ in 0..count {
                    let record = &self.faces[face as usize];
                    assert_eq!((record.cell, record.lobe), (node.morton, lobe), "face {face}");
                    let axis = lobe as usize / 2;
                    let is_tilted = (0..3).any(|i| {
                        i != axis && (record.vector_area[i].abs() * 127.0 + 0.5).floor() > 0.0
                    });
                    tilted |= u32::from(is_tilted) << lobe;
                    assert!((0.0..=1.0 + 1e-6).contains(&along(record)), "{record:?}");
                    let reflectance = record.reflectance.iter();
                    assert!(reflectance.clone().all(|r| (0.0..=0.99).contains(r)), "{record:?}");
                    face += 1;
                }
            }
            assert_eq!(node.lobes >> 8 & 0x3f, tilted, "tilted lobes of voxel {voxel}");
        }
        assert_eq!(self.faces.len() as u32, face);
        assert!(self.stats.faces >= face, "what dynamic surface replaces stays in the list");
        assert_eq!(self.stats.voxels, self.level_starts[1]);
    }
}

/// The component of a face's area along its lobe.
pub fn along(face: &FaceRecord) -> f32 {
    let sign = if face.lobe.is_multiple_of(2) { 1.0 } else { -1.0 };
    sign * face.vector_area[face.lobe as usize / 2]
}
