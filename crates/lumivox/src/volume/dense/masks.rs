//! Masks for skipping empty space in the tracer (`masks.wgsl`), filled by `mark_masks.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer, uniform_buffer,
};
use crate::voxels::{LIST_COUNT_BYTES, VoxelList, level_arguments, level_block};
use crate::{GiError, Grid};

/// Number of levels that a grid can have: 1024 voxels down to 4.
pub(crate) const MASK_LEVELS: usize = 9;

/// `MaskLevels` of `masks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MaskLevels {
    pub(crate) first_entry: [[u32; 4]; MASK_LEVELS],
}

/// Number of entries of a level.
fn entries(grid: &Grid, level: u32) -> u64 {
    (grid.level_dimensions(level) + 1).as_u64vec3().element_product()
}

/// Bytes of the masks of all levels, two per entry.
pub(super) fn bytes(grid: &Grid) -> u64 {
    (0..grid.levels).map(|level| entries(grid, level)).sum::<u64>().div_ceil(2) * 4
}

#[derive(Debug)]
pub(super) struct Masks {
    level_count: u32,
    /// Bind group of each level, and the list's counts.
    bound: Option<(Vec<BindGroup>, Buffer)>,
    levels_uniform: Buffer,
    entries: Buffer,
    layout: wgpu::BindGroupLayout,
    mark: Kernel,
}

impl Masks {
    pub(super) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        grid: &Grid,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let mut levels = MaskLevels::zeroed();
        let mut count = 0_u64;
        for level in 0..grid.levels {
            levels.first_entry[level as usize][0] = count as u32;
            count += entries(grid, level);
        }
        let bytes = bytes(grid);
        let limits = device.limits();
        let available = limits.max_storage_buffer_binding_size.min(limits.max_buffer_size);
        if bytes > available {
            return Err(GiError::Limit {
                what: format!(
                    "the empty-space mask of a dense volume of {} voxels",
                    grid.dimensions
                ),
                needed: bytes,
                unit: "bytes",
                limit: "max_storage_buffer_binding_size",
                available,
                remedy: "lower the resolution".to_owned(),
            });
        }
        let layout =
            LayoutBuilder::compute().uniform().storage().storage_mut().build(device, "mask marks");
        let mark =
            Kernel::new(device, shaders, "volume::dense::mark_masks", "main", &[globals, &layout])?;
        Ok(Self {
            level_count: grid.levels,
            bound: None,
            levels_uniform: uniform_buffer(device, "mask levels", &levels),
            entries: storage_buffer(device, "empty-space masks", bytes),
            layout,
            mark,
        })
    }

    /// Binds another list, or the same one after its buffers were resized.
    pub(super) fn bind(&mut self, device: &wgpu::Device, voxels: &VoxelList) {
        let group = |level| {
            BindGroupBuilder::new(&self.layout)
                .slice(&voxels.counts, level_block(level), LIST_COUNT_BYTES)
                .buffer(&voxels.nodes)
                .buffer(&self.entries)
                .build(device, "mask marks")
        };
        let groups = (0..self.level_count).map(group).collect();
        self.bound = Some((groups, voxels.counts.clone()));
    }

    /// Fills the masks from the list.
    pub(super) fn fill(&self, recorder: &mut Recorder<'_>, grid: &BindGroup) {
        let Some((groups, counts)) = &self.bound else { return };
        recorder.clear(&self.entries);
        recorder.compute("volume::dense::mark_masks", |pass| {
            for (level, group) in (0..).zip(groups) {
                let arguments = level_arguments(level);
                self.mark.dispatch_indirect(pass, &[grid, group], counts, arguments);
            }
        });
    }

    pub(super) fn levels_uniform(&self) -> &Buffer {
        &self.levels_uniform
    }

    pub(super) fn entries(&self) -> &Buffer {
        &self.entries
    }
}
