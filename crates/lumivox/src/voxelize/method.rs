//! Ways from triangles to voxels, and the choice between them in each walk.

use super::Voxelizer;
use super::batch::SplitBatch;
use crate::Grid;
use crate::gpu::{BindGroup, Recorder};

/// How the voxels of a triangle are found.
///
/// All but [`Self::Exact`] are the hardware rasterizer's, and here to be compared with it: they miss voxels or
/// find too many, and the surface in a voxel is an estimate. Only the grid, never the viewer, decides in any of
/// them. See `docs/voxelizers.md`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum VoxelizeMethod {
    /// Every voxel that the triangle touches, by separating axes (Schwarz and Seidel 2010), with the area and
    /// the centroid of the piece in it.
    #[default]
    Exact,
    /// The triangle is drawn along its normal's dominant axis, and each pixel's centre that it covers is the
    /// voxel at its depth there: an area of 1. Thin parts fall between the centres.
    DominantAxis,
    /// As before, but every pixel that the triangle touches, with all voxels that its plane passes there within
    /// the triangle's box (Hasselgren, Akenine-Möller and Ohlsson 2005; Crassin and Green 2012). Misses nothing;
    /// the area covered in a pixel is exact, its distribution along the depth an estimate.
    Conservative,
    /// The triangle is drawn along all three axes, pixels' centres alone: less falls between them. The three
    /// share out one area.
    ThreePlane,
}

impl VoxelizeMethod {
    /// All methods.
    pub const ALL: [Self; 4] =
        [Self::Exact, Self::DominantAxis, Self::Conservative, Self::ThreePlane];

    /// The method's name in lower case, as on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Exact => "exact",
            Self::DominantAxis => "dominant-axis",
            Self::Conservative => "conservative",
            Self::ThreePlane => "three-plane",
        }
    }
}

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
