//! Moves a clipmap's boxes with a camera.

use super::Gi;
use crate::GiError;

impl Gi {
    /// Centres the boxes of a clipmap ([`Grid::cascades`](crate::Grid::cascades)) on a place in the
    /// world, m, usually the camera's. Returns `true` if the boxes have to move: the next
    /// voxelization moves them. [`Self::voxelize`] does so at once. [`Self::frame`] voxelizes the
    /// moved boxes over a few frames without waiting and shows the old ones until then; voxels that
    /// stay in a box keep their light. A move in progress is finished before the next one starts.
    ///
    /// # Errors
    /// As [`Grid::center_on`](crate::Grid::center_on).
    pub fn center_on(&mut self, place: glam::Vec3) -> Result<bool, GiError> {
        let mut grid = *self.scene.grid();
        grid.center_on(place)?;
        let before = self.scene.wanted;
        let moves = self.scene.move_to(grid);
        self.is_refused &= self.scene.wanted == before;
        Ok(moves)
    }

    /// Work items of the last walks over static draws.
    #[cfg(test)]
    pub(crate) fn static_items(&self) -> u64 {
        self.scene.static_items()
    }
}

/// Refuses a caller's own method with cascades, since it handles only one box.
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
