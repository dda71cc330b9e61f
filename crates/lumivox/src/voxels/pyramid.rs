//! The coarser levels of bits, a bit per cell in Morton order: a cell's is set if that of any child
//! is.

use bytemuck::{Pod, Zeroable};

use crate::Grid;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, uniform_buffer,
};

/// `PyramidParams` of `pyramid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct PyramidParams {
    pub child_first_word: u32,
    pub child_words: u32,
    pub parent_first_word: u32,
    pub parent_words: u32,
}

/// Words of the occupancy bits of a level; `level_words` of `lookup.wgsl`.
pub(super) fn level_words(grid: &Grid, level: u32) -> u64 {
    (u64::from(grid.morton_edge(level)).pow(3) / 32).max(1)
}

/// The words before those of a level; `level_first_word` of `lookup.wgsl`.
pub(crate) fn level_first_word(grid: &Grid, level: u32) -> u64 {
    (0..level).map(|finer| level_words(grid, finer)).sum()
}

/// The places of a level's bits in their buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BitLevel {
    pub first_word: u32,
    pub words: u32,
}

/// The kernel.
#[derive(Debug)]
pub(crate) struct Pyramid {
    layout: wgpu::BindGroupLayout,
    kernel: Kernel,
}

impl Pyramid {
    /// Compiles the kernel; group 0 is the grid.
    pub fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, ShaderError> {
        let layout =
            LayoutBuilder::compute().uniform().storage_mut().build(device, "voxels::pyramid");
        let kernel = Kernel::new(device, shaders, "voxels::pyramid", "main", &[globals, &layout])?;
        Ok(Self { layout, kernel })
    }

    /// Fills the coarser levels of bits that are laid out as the list's occupancy.
    pub fn fill(&self, recorder: &mut Recorder, globals: &BindGroup, grid: &Grid, bits: &Buffer) {
        let levels: Vec<BitLevel> = (0..grid.levels)
            .map(|level| BitLevel {
                first_word: level_first_word(grid, level) as u32,
                words: level_words(grid, level) as u32,
            })
            .collect();
        self.fill_levels(recorder, globals, bits, &levels);
    }

    /// Fills all levels but the first one given, each from the one before.
    pub fn fill_levels(
        &self,
        recorder: &mut Recorder,
        globals: &BindGroup,
        bits: &Buffer,
        levels: &[BitLevel],
    ) {
        let device = recorder.device().clone();
        let groups: Vec<_> = levels
            .windows(2)
            .map(|pair| {
                let params = PyramidParams {
                    child_first_word: pair[0].first_word,
                    child_words: pair[0].words,
                    parent_first_word: pair[1].first_word,
                    parent_words: pair[1].words,
                };
                let uniform = uniform_buffer(&device, "pyramid parameters", &params);
                let group = BindGroupBuilder::new(&self.layout)
                    .buffer(&uniform)
                    .buffer(bits)
                    .build(&device, "voxels::pyramid");
                (group, u64::from(params.parent_words))
            })
            .collect();
        recorder.compute("voxels::pyramid", |pass| {
            for (group, words) in &groups {
                self.kernel.dispatch_linear(pass, &[globals, group], *words);
            }
        });
    }
}
