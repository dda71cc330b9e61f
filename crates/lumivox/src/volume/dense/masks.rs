//! The masks that let the tracer pass over empty space (`masks.wgsl`), filled by `mark_masks.wgsl`.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    storage_buffer, uniform_buffer,
};
use crate::volume::level_range::NodeRange;
use crate::voxels::VoxelList;
use crate::{GiError, Grid};

/// `MAX_LEVELS` of `masks.wgsl`.
const MAX_LEVELS: usize = 9;

/// `MaskLevels` of `masks.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct MaskLevels {
    pub(crate) first_entry: [[u32; 4]; MAX_LEVELS],
}

/// Entries of a level.
fn entries(grid: &Grid, level: u32) -> u64 {
    (grid.level_dimensions(level) + 1).as_u64vec3().element_product()
}

/// Bytes of the masks of all levels, two an entry.
pub(super) fn bytes(grid: &Grid) -> u64 {
    (0..grid.levels).map(|level| entries(grid, level)).sum::<u64>().div_ceil(2) * 4
}

#[derive(Debug)]
pub(super) struct Masks {
    levels: MaskLevels,
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
            levels,
            levels_uniform: uniform_buffer(device, "mask levels", &levels),
            entries: storage_buffer(device, "empty-space masks", bytes),
            layout,
            mark,
        })
    }

    pub(super) fn rebuild(&self, recorder: &mut Recorder, grid: &BindGroup, voxels: &VoxelList) {
        recorder.clear(&self.entries);
        let device = recorder.device().clone();
        let groups: Vec<_> = (0..voxels.level_starts.len() as u32 - 1)
            .map(|level| {
                let first_mask_entry = self.levels.first_entry[level as usize][0];
                let range = NodeRange { first_mask_entry, ..NodeRange::new(voxels, level) };
                let uniform = uniform_buffer(&device, "mask range", &range);
                let group = BindGroupBuilder::new(&self.layout)
                    .buffer(&uniform)
                    .buffer(&voxels.nodes)
                    .buffer(&self.entries)
                    .build(&device, "mask marks");
                (group, range.count)
            })
            .collect();
        recorder.compute("volume::dense::mark_masks", |pass| {
            for (group, count) in &groups {
                self.mark.dispatch_linear(pass, &[grid, group], u64::from(*count));
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
