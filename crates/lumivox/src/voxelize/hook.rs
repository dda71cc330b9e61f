//! The hook for a caller's own way from triangles to voxels.

use std::fmt::Debug;
use std::ops::Range;

use super::batch::SplitBatch;
use super::kernels::Layouts;
use crate::gpu::{BindGroup, Pipelines, Recorder, ShaderLibrary};
use crate::{GiError, Grid};

/// How voxels of triangles, and the surface in them, are found, instead of by the exact walk.
///
/// Write one to use what your hardware is good at (a rasterizer, ray queries), or to trade voxels for time. It records
/// what it finds by the functions of `package::voxelize::mark`, `planes` and `accumulate`, into the same bits and sums,
/// so that lists, layers, static shares and all that comes after work with it as they are.
pub trait Voxelization: Debug + Send + Sync {
    /// The name; settings that name the same voxelization are equal.
    fn name(&self) -> &'static str;

    /// The shader stages of its walks, next to compute. They read triangles in all of them, and write in fragments.
    fn stages(&self) -> wgpu::ShaderStages {
        wgpu::ShaderStages::NONE
    }

    /// Makes what walks on a device.
    ///
    /// # Errors
    /// As [`crate::Gi::with_pipelines`], which passes them on.
    fn make(&self, shares: &VoxelizationShares<'_>) -> Result<Box<dyn Walker>, GiError>;
}

/// Voxelizations are compared by their names.
impl PartialEq for dyn Voxelization {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

/// What a [`Voxelization`] can be made of.
#[derive(Clone, Copy, Debug)]
pub struct VoxelizationShares<'a> {
    /// The device, with its pipelines.
    pub device: &'a Pipelines,
    /// All of Lumivox's modules; add your own to a clone.
    pub shaders: &'a ShaderLibrary,
    pub(super) layouts: &'a Layouts,
}

impl<'a> VoxelizationShares<'a> {
    /// The layouts of a step's bind groups: the grid, the triangles, what the step reads and writes, and the textures of
    /// a run of triangles, as `package::voxelize` declares them.
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
    /// To find which voxels are occupied.
    Mark,
    /// To find which lobes they have, how much surface, and of each lobe the plane in front and that at the back.
    Planes,
    /// To find the planes between these two.
    MorePlanes,
    /// To sum up what their faces are made of.
    Accumulate,
}

/// What there is to sample of a run of triangles: `UNIFORM`, `VARIED` and `PIERCED` of `package::voxelize::surface`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Detail {
    /// One look all over.
    Uniform,
    /// Textures or colours.
    Varied,
    /// Light passes, by holes or by transmission; textures and colours as well.
    Pierced,
}

/// What a [`Voxelization`] makes.
pub trait Walker: Debug + wgpu::WasmNotSendSync {
    /// Records a walk for a step, and says whether it did: where not, the exact walk does.
    fn walk(&self, recorder: &mut Recorder, step: WalkStep, walk: &Walk<'_>) -> bool;
}

/// All triangles, for one step.
#[derive(Clone, Copy, Debug)]
pub struct Walk<'a> {
    /// Where the voxels are.
    pub grid: &'a Grid,
    /// The pass's name among the times.
    pub label: &'static str,
    pub(super) globals: &'a BindGroup,
    pub(super) batches: &'a [SplitBatch],
    pub(super) pass_groups: &'a [BindGroup],
}

/// Triangles that are walked together: they share textures.
#[derive(Clone, Debug)]
pub struct WalkRun<'a> {
    /// What there is to sample of them.
    pub detail: Detail,
    /// Their numbers in their batch.
    pub triangles: Range<u32>,
    /// Their bind groups, of the layouts of the step ([`VoxelizationShares::layouts`]).
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
