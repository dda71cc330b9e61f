//! The voxels' faces with their light, read back from the GPU.

use glam::{UVec3, Vec3};
use lumivox::gpu::read_buffer;
use lumivox::voxels::FaceRecord;

use super::Renderer;
use crate::RenderError;

/// The surface within a voxel that faces one way.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelFace {
    /// The mean position of the surface in the world, m.
    pub position: Vec3,
    /// The sum of area times normal, in m²; at most the area of the voxel's side along the axis.
    pub vector_area: Vec3,
    /// The voxel's position in the grid.
    pub cell: UVec3,
    /// The axis that it faces: +x, -x, +y, -y, +z, -z as 0 to 5.
    pub axis: u32,
    /// The mean diffuse reflectance of the light that enters, RGB.
    pub reflectance: Vec3,
    /// The mean emitted radiance, cd/m².
    pub emission: Vec3,
    /// The outgoing radiance, cd/m², that the last gather reads: with one bounce fewer than the
    /// settings have.
    pub radiance: Vec3,
}

impl Renderer {
    /// The faces of all voxels, in the order of the voxel list. Reads them back and waits for the
    /// GPU.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn faces(&self) -> Result<Vec<VoxelFace>, RenderError> {
        let (gi, gpu) = (&self.gi, &self.gpu);
        let (Some(list), Some(lit)) = (gi.voxels(), gi.face_radiance()) else {
            return Ok(Vec::new());
        };
        let count = u64::from(list.face_count);
        if count == 0 {
            return Ok(Vec::new());
        }
        let (device, queue) = (&gpu.device, &gpu.queue);
        let bytes = count * size_of::<FaceRecord>() as u64;
        let faces: Vec<FaceRecord> = read_buffer(device, queue, &list.faces, 0..bytes).await?;
        let lit: Vec<[f32; 4]> = read_buffer(device, queue, lit, 0..count * 16).await?;
        gpu.check("reading the voxels' faces")?;
        let (unit, side) = (self.scene.radiance_unit, gi.grid().voxel_size_m);
        let face = |(face, [r, g, b, _]): (&FaceRecord, &[f32; 4])| VoxelFace {
            position: face.position_in_world.into(),
            vector_area: side * side * Vec3::from(face.vector_area),
            cell: UVec3::from_array([0, 1, 2].map(|axis| coordinate(face.cell, axis))),
            axis: face.lobe,
            reflectance: face.reflectance.into(),
            emission: unit * Vec3::from(face.emission),
            radiance: unit * Vec3::new(*r, *g, *b),
        };
        Ok(faces.iter().zip(&lit).map(face).collect())
    }
}

/// Every third bit of a Morton code, starting at bit `axis`.
fn coordinate(morton: u32, axis: u32) -> u32 {
    (0..10).map(|bit| (morton >> (3 * bit + axis) & 1) << bit).sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coordinates_are_decoded_from_every_third_bit() {
        assert_eq!([0, 1, 2].map(|axis| coordinate(0b110_001, axis)), [1, 2, 2]);
        assert_eq!(coordinate(0x3fff_ffff, 1), 1023);
    }
}
