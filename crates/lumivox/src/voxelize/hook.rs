//! The hook for a caller's own voxelization method.

use std::fmt::Debug;
use std::ops::Range;

use super::batch::SplitBatch;
use super::kernels::Layouts;
use crate::gpu::{BindGroup, Pipelines, Recorder, ShaderLibrary};
use crate::{GiError, Grid};

/// A method to find voxels and the surface in them, instead of the exact walk.
///
/// Implement it to use your hardware's rasterizer or ray queries, or to trade accuracy for time.
/// Its shaders call the functions of `package::voxelize::mark`, `planes` and `accumulate`, which
/// write the same bits and sums, so that lists, layers, static shares and all later stages work
/// unchanged.
pub trait Voxelization: Debug + Send + Sync {
    /// The name; settings that name the same voxelization are equal.
    fn name(&self) -> &'static str;

    /// The shader stages of its walks, in addition to compute. All stages read triangles; only
    /// compute and fragment shaders write.
    fn stages(&self) -> wgpu::ShaderStages {
        wgpu::ShaderStages::NONE
    }

    /// Creates the walker on a device.
    ///
    /// # Errors
    /// Returned by [`crate::Gi::with_pipelines`].
    fn make(&self, shares: &VoxelizationShares<'_>) -> Result<Box<dyn Walker>, GiError>;
}

/// Voxelizations are compared by their names.
impl PartialEq for dyn Voxelization {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// Parts that a [`Voxelization`] can use to create its [`Walker`].
#[derive(Clone, Copy, Debug)]
pub struct VoxelizationShares<'a> {
    /// The device, with its pipelines.
    pub device: &'a Pipelines,
    /// All of Lumivox's modules; add your own to a clone.
    pub shaders: &'a ShaderLibrary,
    pub(super) layouts: &'a Layouts,
}

impl<'a> VoxelizationShares<'a> {
    /// The layouts of a step's bind groups: the grid, the triangles, the step's inputs and outputs,
    /// and the textures of a run of triangles, as `package::voxelize` declares them.
    pub fn layouts(&self, step: WalkStep) -> [&'a wgpu::BindGroupLayout; 4] {
        let Layouts { grid, triangles, mark, planes, accumulate, run, .. } = self.layouts;
        let own = match step {
            WalkStep::Mark => mark,
            WalkStep::Planes | WalkStep::MorePlanes => planes,
            WalkStep::Accumulate => accumulate,
        };
        [grid, triangles, own, run]
    }
}

/// The purpose of a walk over the voxels of all triangles.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WalkStep {
    /// Find the occupied voxels.
    Mark,
    /// Find their lobes, the area of their surface, and the front and back plane of each lobe.
    Planes,
    /// Find the planes between the front and the back plane.
    MorePlanes,
    /// Sum up the attributes of faces.
    Accumulate,
}

/// The detail to sample for a run of triangles: `UNIFORM`, `VARIED` and `PIERCED` of
/// `package::voxelize::surface`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Detail {
    /// Constant appearance.
    Uniform,
    /// Textures or colours.
    Varied,
    /// Textures, colours, and light that passes by holes or transmission.
    Pierced,
}

/// Created by a [`Voxelization`].
pub trait Walker: Debug + wgpu::WasmNotSendSync {
    /// Records a walk for a step and returns `true`, or returns `false` to leave the step to the
    /// exact walk.
    fn walk(&self, recorder: &mut Recorder, step: WalkStep, walk: &Walk<'_>) -> bool;
}

/// All triangles, for one step.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a> {
    /// The grid of the voxels.
    pub grid: &'a Grid,
    /// The pass's name in timings.
    pub label: &'static str,
    pub(super) globals: &'a BindGroup,
    pub(super) batches: &'a [SplitBatch],
    pub(super) pass_groups: &'a [BindGroup],
}

/// Triangles that are walked together, since they share textures.
#[derive(Clone, Debug)]
pub struct WalkRun<'a> {
    /// The detail to sample.
    pub detail: Detail,
    /// The triangles' range in the numbering of their batch.
    pub triangles: Range<u32>,
    /// The bind groups, of the layouts of the step ([`VoxelizationShares::layouts`]).
    pub groups: [&'a BindGroup; 4],
}

impl<'a> Walk<'a> {
    /// The runs of all batches.
    pub fn runs(&self) -> impl Iterator<Item = WalkRun<'a>> {
        let globals = self.globals;
        let batches = self.batches.iter().zip(self.pass_groups);
        batches.flat_map(move |(batch, own)| batch.runs(globals, own))
    }
}
