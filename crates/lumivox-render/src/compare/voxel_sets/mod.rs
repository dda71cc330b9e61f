//! The voxels of a voxelizer, read back for comparison.

mod difference;
mod view;

pub use difference::SetDifference;
pub use view::{EXTRA_COLOR, MISSING_COLOR, voxel_set_picture};

use bytemuck::Pod;
use glam::{UVec3, Vec3};
use lumivox::Grid;
use lumivox::gpu::{Buffer, read_buffer};
use lumivox::voxels::{FaceRecord, NodeRecord, VoxelList};

use crate::{Gpu, RenderError};

/// An occupied voxel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Voxel {
    /// Position in the grid: interleaved bits of the coordinates, x in the lowest.
    pub morton: u32,
    /// The sum over its faces of the area along the lobe, in units of a voxel's side. 0 if the
    /// voxel is only touched.
    pub area: f32,
    /// The diffuse reflectance: the mean over its faces, weighted by `area`.
    pub reflectance: Vec3,
}

/// All occupied voxels of a scene.
#[derive(Clone, Debug, PartialEq)]
pub struct VoxelSet {
    grid: Grid,
    /// In Morton order.
    voxels: Vec<Voxel>,
}

impl VoxelSet {
    /// Creates a set of voxels; their order does not matter.
    pub fn new(grid: Grid, mut voxels: Vec<Voxel>) -> Self {
        voxels.sort_by_key(|voxel| voxel.morton);
        Self { grid, voxels }
    }

    /// Reads the finest level of a list back from the GPU.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn read(gpu: &Gpu, grid: &Grid, list: &VoxelList) -> Result<Self, RenderError> {
        let count = u64::from(list.voxel_count());
        let nodes: Vec<NodeRecord> = read(gpu, &list.nodes, count).await?;
        let faces: Vec<FaceRecord> = read(gpu, &list.faces, u64::from(list.face_count)).await?;
        let touched =
            |node: &NodeRecord| Voxel { morton: node.morton, area: 0.0, reflectance: Vec3::ZERO };
        let mut voxels: Vec<Voxel> = nodes.iter().map(touched).collect();
        let first_faces: Vec<u32> = read(gpu, &list.first_faces, count).await?;
        let of_voxels =
            nodes.iter().zip(&first_faces).enumerate().flat_map(|(index, (node, &first))| {
                let count = node.faces();
                faces[first as usize..(first + count) as usize]
                    .iter()
                    .map(move |face| (index, face))
            });
        for (index, face) in of_voxels {
            let voxel = &mut voxels[index];
            let area = face.vector_area[face.lobe as usize / 2].abs();
            voxel.area += area;
            voxel.reflectance += area * Vec3::from(face.reflectance);
        }
        for voxel in voxels.iter_mut().filter(|voxel| voxel.area > 0.0) {
            voxel.reflectance /= voxel.area;
        }
        Ok(Self::new(*grid, voxels))
    }

    /// The grid of the voxels.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// The voxels, in Morton order.
    pub fn voxels(&self) -> &[Voxel] {
        &self.voxels
    }

    /// The voxel with a Morton code, if it is occupied.
    fn get(&self, morton: u32) -> Option<&Voxel> {
        let place = self.voxels.binary_search_by_key(&morton, |voxel| voxel.morton).ok()?;
        self.voxels.get(place)
    }
}

async fn read<T: Pod>(gpu: &Gpu, buffer: &Buffer, count: u64) -> Result<Vec<T>, RenderError> {
    let bytes = count * size_of::<T>() as u64;
    if bytes == 0 {
        return Ok(Vec::new());
    }
    Ok(read_buffer(&gpu.device, &gpu.queue, buffer, 0..bytes).await?)
}

/// Interleaves the bits of a cell's coordinates, of 10 bits each.
fn morton_encode(cell: UVec3) -> u32 {
    let spread = |value: u32| (0..10).map(|i| ((value >> i) & 1) << (3 * i)).sum::<u32>();
    spread(cell.x) | spread(cell.y) << 1 | spread(cell.z) << 2
}

/// The inverse of [`morton_encode`].
fn morton_decode(code: u32) -> UVec3 {
    let gather = |code: u32| (0..10).map(|i| ((code >> (3 * i)) & 1) << i).sum::<u32>();
    UVec3::new(gather(code), gather(code >> 1), gather(code >> 2))
}

#[cfg(test)]
mod tests;
