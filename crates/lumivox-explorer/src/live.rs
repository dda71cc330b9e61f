//! Functions that only interactive front ends need: reading a scene again, and times of stages.

use std::collections::HashSet;

use lumivox::gpu::{StageTime, Timing};
use lumivox_render::PresetChoice;

use crate::Explorer;
use crate::opened::PreparedScene;

impl Explorer {
    /// Shows a scene that was read again. The camera, the stored views and the changes of objects
    /// that still exist are kept. Returns the number of objects whose changes were kept.
    pub fn reopen(&mut self, mut opened: PreparedScene) -> usize {
        let (camera, positions) = (self.camera.clone(), self.positions.clone());
        let stored = std::mem::take(&mut self.stored);
        if let Some(old) = &mut self.opened {
            let edits = std::mem::take(&mut old.edits);
            let names: HashSet<&String> = opened.names.iter().collect();
            opened.edits = edits.into_iter().filter(|(name, _)| names.contains(name)).collect();
        }
        opened.apply_edits();
        let kept = opened.edits.len();
        self.open(opened);
        (self.camera, self.positions, self.stored) = (camera, positions, stored);
        kept
    }

    /// Records the preset that the settings started from.
    pub fn note_preset(&mut self, preset: PresetChoice) {
        self.preset = preset;
    }

    /// Sets whether the times of stages are measured. Measuring takes some time itself.
    pub fn set_timed(&mut self, is_timed: bool) {
        let timing = if is_timed { Timing::for_device(&self.gpu.device) } else { Timing::Off };
        self.settings.timing = timing;
    }

    /// The times of all passes since the last call; empty unless they are measured.
    pub fn take_stage_times(&mut self) -> Vec<StageTime> {
        let Some(renderer) = &mut self.renderer else { return Vec::new() };
        let times = renderer.times();
        renderer.forget_times();
        times
    }
}
