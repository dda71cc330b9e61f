//! Performance figures of a frame: sums over one pixel in 64, at almost no cost.

use glam::UVec2;
use lumivox::GiView;
use lumivox::gpu::{
    BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, TextureView, storage_buffer,
};

/// Distance between counted pixels, px.
pub(super) const FIGURE_SPACING: u32 = 8;

/// Sums up the figures of a frame.
#[derive(Debug)]
pub(crate) struct FiguresPass {
    kernel: Kernel,
    layout: wgpu::BindGroupLayout,
    sums: Buffer,
}

/// The sums over the sampled pixels.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Sums {
    /// Sampled pixels.
    pub(crate) pixels: u32,
    pub(crate) samples: u32,
    /// Pixels that have a record of earlier frames.
    pub(crate) known: u32,
    pub(crate) frames: u32,
}

impl FiguresPass {
    /// Creates the pipeline.
    ///
    /// # Errors
    /// When the shader does not link.
    pub(crate) fn new(device: &Pipelines, shaders: &ShaderLibrary) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .storage_mut()
            .texture_2d_unfilterable()
            .texture(wgpu::TextureViewDimension::D2, wgpu::TextureSampleType::Uint)
            .build(device, "figures");
        let kernel = Kernel::new(device, shaders, "render::passes::figures", "main", &[&layout])?;
        Ok(Self { kernel, layout, sums: storage_buffer(device, "figures", 16) })
    }

    /// Sums over the pixels traced last; `no_records` is bound if there are no records. The buffer
    /// contains the sums after submission.
    pub(crate) fn record(
        &self,
        recorder: &mut Recorder,
        traced: &GiView,
        no_records: &TextureView,
    ) -> &Buffer {
        recorder.clear(&self.sums);
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&self.sums)
            .view(traced.specular())
            .view(traced.records().unwrap_or(no_records))
            .build(recorder.device(), "figures");
        let UVec2 { x, y } = places(traced.size());
        self.kernel.run(recorder, &[&group], [x, y, 1]);
        &self.sums
    }
}

impl Sums {
    /// Decodes the buffer for a traced picture of the given size.
    pub(crate) fn new(words: &[u32], size: UVec2) -> Self {
        let word = |index: usize| words.get(index).copied().unwrap_or_default();
        let pixels = places(size).element_product();
        Self { pixels, samples: word(0), known: word(1), frames: word(2) }
    }
}

/// Sampled pixels along each edge.
fn places(size: UVec2) -> UVec2 {
    size.map(|pixels| pixels.div_ceil(FIGURE_SPACING))
}
