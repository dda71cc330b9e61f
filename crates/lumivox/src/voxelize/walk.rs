//! The walks over all batches, by whichever method.

use super::Voxelizer;
use super::batch::SplitBatch;
use crate::Grid;
use crate::gpu::{BindGroup, Recorder};

/// What the voxels are walked for.
#[derive(Clone, Copy, Debug)]
pub(super) enum Step {
    /// Which are occupied.
    Mark,
    /// Which lobes they have, and how much surface.
    Lobes,
    /// What is in front where there are layers. Walked exactly by all methods.
    Fronts,
    /// What their faces are made of.
    Accumulate,
}

impl Voxelizer {
    /// Walks all batches for a step, by this voxelizer's method; `pass_groups` are their bind groups 2.
    pub(super) fn walk(
        &self,
        recorder: &mut Recorder,
        (grid, globals): (&Grid, &BindGroup),
        batches: &[SplitBatch],
        pass_groups: &[BindGroup],
        step: Step,
    ) {
        let (kernels, label) = match step {
            Step::Mark => (&self.kernels.mark, "voxelize::mark"),
            Step::Lobes => (&self.kernels.lobes, "voxelize::lobes"),
            Step::Fronts => (&self.kernels.fronts, "voxelize::fronts"),
            Step::Accumulate => (&self.kernels.accumulate, "voxelize::accumulate"),
        };
        let batches = batches.iter().zip(pass_groups);
        let drawn = self.raster.as_ref().and_then(|raster| Some((raster, raster.variants(step)?)));
        if let Some((raster, variants)) = drawn {
            raster.walk(recorder, label, (grid, globals), batches, variants);
            return;
        }
        recorder.compute(label, |pass| {
            for (batch, group) in batches {
                batch.walk(pass, globals, group, |run| kernels.choose(run.detail));
            }
        });
    }
}
