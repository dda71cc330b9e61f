//! Volumes: where the radiance of the voxel list is stored, filtered into a pyramid, and sampled by cones.
//!
//! All volumes are filled from the same [`VoxelList`](crate::voxels::VoxelList) and stand behind one interface:
//! in Rust the methods of [`Volume`], in shaders the module `package::volume` with `probe_volume`,
//! `is_empty`, `is_oblique`, `sample_probe` and `load_cell`, bound as group 0. A new kind of volume is a new
//! folder, a new variant, and nothing else.

pub(crate) mod changes;
mod dense;

use crate::gpu::{Recorder, ShaderLibrary};
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

use changes::ChangedCells;
use dense::DenseVolume;
pub use dense::Directionality;
pub(crate) use dense::mount;
#[cfg(test)]
pub(crate) use dense::{Level, LevelWords, MaskLevels, NodeRange, read_levels};

/// The shader modules of all volumes but for the one that `package::volume` stands for.
pub(crate) const MODULES: [&[(&str, &str)]; 2] = [changes::MODULES, dense::MODULES];

/// A volume on the GPU.
#[derive(Debug)]
pub(crate) enum Volume {
    /// 3D textures over the whole grid.
    Dense(DenseVolume),
}

impl Volume {
    /// Makes an empty volume over a grid, and mounts its shader as `package::volume`.
    pub(crate) fn new(
        device: &wgpu::Device,
        shaders: &mut ShaderLibrary,
        grid: &Grid,
        directionality: Directionality,
    ) -> Result<Self, GiError> {
        DenseVolume::new(device, shaders, grid, directionality).map(Self::Dense)
    }

    /// Takes a new voxel list: forgets the last one's voxels and prepares for the new one's. The radiance is
    /// not there before [`Self::update`].
    ///
    /// `wrong` are the cells of another surface than the last list's, which hold what must go; `changed` is the list
    /// that updates will come with.
    pub(crate) fn rebuild(
        &mut self,
        recorder: &mut Recorder,
        voxels: &VoxelList,
        radiance: &wgpu::Buffer,
        (wrong, changed): (Option<&ChangedCells>, &ChangedCells),
    ) {
        match self {
            Self::Dense(dense) => dense.rebuild(recorder, voxels, radiance, (wrong, changed)),
        }
    }

    /// Stores the radiance of the faces and filters it into the pyramid, where it has changed.
    pub(crate) fn update(&self, recorder: &mut Recorder, changed: &ChangedCells) {
        match self {
            Self::Dense(dense) => dense.update(recorder, changed),
        }
    }

    /// Group 0: the grid and the volume, for sampling.
    pub(crate) fn globals(&self) -> &wgpu::BindGroup {
        match self {
            Self::Dense(dense) => dense.globals(),
        }
    }

    /// The layout of [`Self::globals`].
    pub(crate) fn globals_layout(&self) -> &wgpu::BindGroupLayout {
        match self {
            Self::Dense(dense) => dense.globals_layout(),
        }
    }

    /// Bytes on the GPU, by what they hold.
    pub(crate) fn memory(&self) -> Vec<(&'static str, u64)> {
        match self {
            Self::Dense(dense) => dense.memory(),
        }
    }
}
