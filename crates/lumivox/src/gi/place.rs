//! The place of a clipmap's boxes, which follow a camera.

use super::{Gi, GiConfig};
use crate::GiError;
use crate::gpu::{Buffer, Pipelines};
use crate::light::Lighting;
use crate::volume::Volume;
use crate::voxelize::Taken;

impl Gi {
    /// Lets the boxes of a clipmap ([`Grid::cascades`](crate::Grid::cascades)) follow a place in the world, m: that of the camera. Whether they have to
    /// move is returned; if so, the next voxelization moves them. [`Self::voxelize`] does so at once. [`Self::voxelize_frame`]
    /// makes the voxels of the moved boxes over a few frames, in which all stays what it was, without waiting; voxels that
    /// stay in a box keep the light that they have gathered. While one move is on its way, the next one waits.
    ///
    /// # Errors
    /// As [`Grid::center_on`](crate::Grid::center_on).
    pub fn center_on(&mut self, place: glam::Vec3) -> Result<bool, GiError> {
        let mut grid = *self.scene.grid();
        grid.center_on(place)?;
        Ok(self.scene.move_to(grid))
    }

    /// Work items of the last walks over static draws.
    #[cfg(test)]
    pub(crate) fn static_items(&self) -> u64 {
        self.scene.static_items()
    }
}

/// Lets light and volume go on with the grid of a list that is about to be taken.
pub(super) fn move_to(
    device: &Pipelines,
    taken: &Taken<'_>,
    config: &mut GiConfig,
    (lighting, volume, emitters): (&mut Lighting, &mut Volume, &Buffer),
) {
    if config.grid == *taken.grid {
        return;
    }
    config.grid = *taken.grid;
    lighting.move_to(device, taken.grid);
    volume.move_to(device, taken.grid, emitters);
}

/// Ways of the caller's own know one box alone.
pub(super) fn refuse_with_cascades(name: &'static str, is_given: bool) -> Result<(), GiError> {
    if !is_given {
        return Ok(());
    }
    Err(GiError::Setting {
        name,
        value: "a way of the caller's own".to_owned(),
        expected: "none with cascades; a dense volume or an octree takes one".to_owned(),
    })
}
