//! Advances time: animations, and voxels that are renewed at intervals.

use web_time::Instant;

use crate::{Explorer, ExplorerError, Revoxelize};

/// The longest step of an animation, s: after a long pause it continues where it was.
const LONGEST_STEP_S: f32 = 1.0;

impl Explorer {
    /// Advances time: the animation moves, and voxels are made again if [`Explorer::revoxelize`]
    /// requires it. Sequences pass the duration of each frame, scripts a nominal one. Returns
    /// whether the scene has changed.
    ///
    /// # Errors
    /// When the scene has no triangles left at the new time.
    pub fn tick(&mut self, seconds: f32) -> Result<bool, ExplorerError> {
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
        Ok(is_due || self.playback().is_playing)
    }

    /// Advances by the time that has passed since the last call, for pictures on a screen.
    ///
    /// # Errors
    /// As [`Self::tick`].
    pub fn tick_clock(&mut self) -> Result<bool, ExplorerError> {
        let now = Instant::now();
        let passed_s = (now - std::mem::replace(&mut self.ticked, now)).as_secs_f32();
        let is_playing = self.playback().is_playing;
        self.tick(if is_playing { passed_s.min(LONGEST_STEP_S) } else { passed_s })
    }

    /// Whether the scene changes without further commands.
    pub fn changes_by_itself(&self) -> bool {
        let is_renewed = matches!(self.revoxelize, Revoxelize::Every(_) | Revoxelize::EveryFrame);
        is_renewed || self.playback().is_playing
    }
}
