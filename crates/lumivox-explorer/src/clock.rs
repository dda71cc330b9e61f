//! What happens as time goes on.

use crate::{Explorer, ExplorerError, Revoxelize};

impl Explorer {
    /// Lets time go on: what plays moves, and voxels are made anew where [`Explorer::revoxelize`] asks for it. Whoever
    /// renders frames says how long each takes; scripts, how long it is to stand for.
    ///
    /// # Errors
    /// When nothing of the scene is left at the new time.
    pub fn tick(&mut self, seconds: f32) -> Result<(), ExplorerError> {
        self.advance(seconds)?;
        self.since_voxels_s += seconds;
        let is_due = match self.revoxelize {
            Revoxelize::WhenMoved | Revoxelize::WhenAsked => false,
            Revoxelize::Every(period_s) => self.since_voxels_s >= period_s,
            Revoxelize::EveryFrame => true,
        };
        if is_due {
            self.since_voxels_s = 0.0;
            self.ask_for_voxels();
        }
        Ok(())
    }
}
