//! Coarser levels of bits in Morton order from finer ones.

use bytemuck::{Pod, Zeroable};

use crate::gpu::{
    BindGroupBuilder, Kernel, LayoutBuilder, Recorder, ShaderError, ShaderLibrary, uniform_buffer,
};

/// `PyramidParams` of `pyramid.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
struct PyramidParams {
    child_first_word: u32,
    child_words: u32,
    parent_first_word: u32,
    parent_words: u32,
}

/// Where the bits of a level stand in their buffer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct BitLevel {
    pub first_word: u32,
    pub words: u32,
}

/// Sets a bit of a level where one of the eight below it is set.
#[derive(Debug)]
pub(crate) struct BitPyramid {
    layout: wgpu::BindGroupLayout,
    kernel: Kernel,
}

impl BitPyramid {
    /// Compiles the kernel; what group 0 is does not matter to it.
    pub fn new(
        device: &wgpu::Device,
        shaders: &ShaderLibrary,
        globals: &wgpu::BindGroupLayout,
    ) -> Result<Self, ShaderError> {
        let layout =
            LayoutBuilder::compute().uniform().storage_mut().build(device, "voxels::pyramid");
        let kernel = Kernel::new(device, shaders, "voxels::pyramid", "main", &[globals, &layout])?;
        Ok(Self { layout, kernel })
    }

    /// Fills all levels but the first one given, each from the one before.
    pub fn run(
        &self,
        recorder: &mut Recorder,
        globals: &wgpu::BindGroup,
        bits: &wgpu::Buffer,
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

#[cfg(test)]
mod tests {
    use super::PyramidParams;
    use crate::gpu::assert_layout;

    #[test]
    fn structs_lie_in_memory_alike() {
        let library = crate::shaders::library();
        assert_layout!(
            library,
            "voxels::pyramid",
            "PyramidParams",
            PyramidParams { child_first_word, child_words, parent_first_word, parent_words }
        );
    }
}
