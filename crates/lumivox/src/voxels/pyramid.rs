//! The coarser levels of bits, a bit per cell in Morton order, set if that of any child is.

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
pub(crate) fn level_words(grid: &Grid, level: u32) -> u64 {
    (u64::from(grid.morton_edge(level)).pow(3) / 32).max(1)
}

/// The first word of a level; `level_first_word` of `lookup.wgsl`.
pub(crate) fn level_first_word(grid: &Grid, level: u32) -> u64 {
    (0..level).map(|finer| level_words(grid, finer)).sum()
}

/// The place of a level's bits in their buffer.
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

    /// Binds [`Self::run`] for bits that are laid out as the list's occupancy.
    pub fn bind(&self, device: &wgpu::Device, grid: &Grid, bits: &Buffer) -> BoundPyramid {
        let levels: Vec<BitLevel> = (0..grid.levels)
            .map(|level| BitLevel {
                first_word: level_first_word(grid, level) as u32,
                words: level_words(grid, level) as u32,
            })
            .collect();
        self.bind_levels(device, bits, &levels)
    }

    /// Like [`Self::bind`], for the given levels: each is filled from the one before, except the
    /// first.
    pub fn bind_levels(
        &self,
        device: &wgpu::Device,
        bits: &Buffer,
        levels: &[BitLevel],
    ) -> BoundPyramid {
        let groups = levels
            .windows(2)
            .map(|pair| {
                let params = PyramidParams {
                    child_first_word: pair[0].first_word,
                    child_words: pair[0].words,
                    parent_first_word: pair[1].first_word,
                    parent_words: pair[1].words,
                };
                let uniform = uniform_buffer(device, "pyramid parameters", &params);
                let group = BindGroupBuilder::new(&self.layout)
                    .buffer(&uniform)
                    .buffer(bits)
                    .build(device, "voxels::pyramid");
                (group, u64::from(params.parent_words))
            })
            .collect();
        BoundPyramid(groups)
    }

    /// Fills the levels, each from the previous one.
    pub fn run(&self, recorder: &mut Recorder<'_>, globals: &BindGroup, bound: &BoundPyramid) {
        recorder.compute("voxels::pyramid", |pass| {
            for (group, words) in &bound.0 {
                self.kernel.dispatch_linear(pass, &[globals, group], *words);
            }
        });
    }
}

/// The levels of some bits, for [`Pyramid::run`].
#[derive(Debug)]
pub(crate) struct BoundPyramid(Vec<(BindGroup, u64)>);
