//! The mean over frames.
//!
//! After n frames the mean m moves by (x - m) / (n + 1), in full floats: each frame has the same
//! weight, and nothing grows with their number. Two textures take turns, since WebGPU's core cannot
//! both read and write storage textures of this format.

use bytemuck::{Pod, Zeroable};
use glam::UVec2;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, uniform_buffer,
};

use crate::gpu::textures::ScreenTextures;
use crate::passes::composite::PICTURE_FORMAT;

/// `AccumulateSettings` of `accumulate.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct AccumulateSettings {
    pub(crate) frames: u32,
    padding: [u32; 3],
}

/// Averages frames.
#[derive(Debug)]
pub struct AccumulatePass {
    kernel: Kernel,
    settings: Buffer,
    means: [Texture; 2],
    /// Group `i` writes mean `i`.
    groups: [BindGroup; 2],
    size: UVec2,
    frames: u32,
}

impl AccumulatePass {
    /// Makes the pipeline and the textures; `frame` is the texture of each frame.
    ///
    /// # Errors
    /// When the shader does not link.
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        textures: &mut ScreenTextures<'_>,
        size: UVec2,
        frame: &TextureView,
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .uniform()
            .texture_2d_unfilterable()
            .texture_2d_unfilterable()
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT)
            .build(device, "accumulate");
        let kernel =
            Kernel::new(device, shaders, "render::passes::accumulate", "main", &[&layout])?;
        let settings = uniform_buffer(device, "accumulate", &AccumulateSettings::zeroed());
        let means = [(); 2].map(|()| {
            textures.create("mean", PICTURE_FORMAT, wgpu::TextureUsages::STORAGE_BINDING)
        });
        let views = [means[0].view(), means[1].view()];
        let groups = [(1, 0), (0, 1)].map(|(old, new): (usize, usize)| {
            BindGroupBuilder::new(&layout)
                .buffer(&settings)
                .view(frame)
                .view(&views[old])
                .view(&views[new])
                .build(device, "accumulate")
        });
        Ok(Self { kernel, settings, means, groups, size, frames: 0 })
    }

    /// Frames in the mean.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Starts again: the next frame replaces the mean.
    pub fn reset(&mut self) {
        self.frames = 0;
    }

    /// Makes the next frame number `frames` of the mean, counted from 0.
    pub(crate) fn follow(&mut self, frames: u32) {
        self.frames = frames;
    }

    /// Adds a frame; once per submission.
    pub fn record(&mut self, recorder: &mut Recorder) {
        let settings = AccumulateSettings { frames: self.frames, padding: [0; 3] };
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        let group = &self.groups[(self.frames % 2) as usize];
        self.kernel.run(recorder, &[group], [self.size.x, self.size.y, 1]);
        self.frames += 1;
    }

    /// The mean of the frames so far; undefined before the first.
    pub fn mean(&self) -> &Texture {
        let newest = self.frames.saturating_sub(1) % 2;
        &self.means[newest as usize]
    }
}
