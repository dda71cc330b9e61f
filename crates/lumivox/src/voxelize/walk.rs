//! The walks over all batches.

use super::Voxelizer;
use super::hook::{Walk, WalkStep};
use crate::gpu::Recorder;

impl WalkStep {
    /// The name of the step's passes.
    pub(super) fn label(self) -> &'static str {
        match self {
            Self::Mark => "voxelize::mark",
            Self::Planes => "voxelize::planes",
            Self::MorePlanes => "voxelize::more_planes",
            Self::Accumulate => "voxelize::accumulate",
        }
    }
}

impl Voxelizer {
    /// Walks all batches for a step, by the caller's walker if it handles the step.
    pub(super) fn walk(&self, recorder: &mut Recorder, step: WalkStep, walk: &Walk<'_>) {
        if walk.batches.is_empty() {
            return;
        }
        if self.walker.as_ref().is_some_and(|walker| walker.walk(recorder, step, walk)) {
            return;
        }
        let kernels = match step {
            WalkStep::Mark => &self.kernels.mark,
            WalkStep::Planes => &self.kernels.planes,
            WalkStep::MorePlanes => &self.kernels.more_planes,
            WalkStep::Accumulate => &self.kernels.accumulate,
        };
        recorder.compute(walk.label, |pass| {
            for (batch, group) in walk.batches.iter().zip(walk.pass_groups) {
                batch.walk(pass, walk.globals, group, |run| kernels.choose(run.detail()));
            }
        });
    }
}
