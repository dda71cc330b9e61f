//! The mean over frames.
//!
//! After n frames the mean m moves by (x - m) / (n + 1), in full floats: each frame has the same
//! weight, and no sum grows with their number. Two textures are swapped each frame, since WebGPU's
//! core cannot both read and write storage textures of this format.
//!
//! With temporal blending, frames already contain the light of all frames before them and improve
//! over time, so later frames get larger weights: m moves by 2 (x - m) / (n + 2). When something
//! moves, the mean is not discarded but reprojected along the surfaces (`follow.wgsl`), and counts
//! as a few frames.

use bytemuck::{Pod, Zeroable};
use glam::UVec2;
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, upload,
};
use lumivox::{Gi, GiView};

use crate::gpu::textures::ScreenTextures;
use crate::passes::composite::PICTURE_FORMAT;

/// The most past frames that a moving picture's mean counts: each lookup between texels blurs it a
/// little.
const MOVING_FRAMES: u32 = 8;

/// `AccumulateSettings` of `accumulate.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct AccumulateSettings {
    pub(crate) weight: f32,
    pub(crate) is_relit: u32,
    padding: [u32; 2],
}

/// Averages frames.
#[derive(Debug)]
pub struct AccumulatePass {
    kernel: Kernel,
    follow: Option<Follow>,
    settings: Buffer,
    means: [Texture; 2],
    /// Bind group `i` writes mean `i`.
    groups: [BindGroup; 2],
    /// Index of the mean that was written last.
    newest: usize,
    size: UVec2,
    frames: u32,
    /// The weight of the newest frame, summed over its samples.
    share: f32,
}

/// The reprojection kernel for blended frames, and the number of past frames in the mean.
#[derive(Debug)]
struct Follow {
    kernel: Kernel,
    /// Bound in place of the groups that the kernel does not use.
    nothing: BindGroup,
    /// The number of past frames in the mean, in addition to those of the current picture.
    past: u32,
}

impl AccumulatePass {
    /// Creates the pipeline and the textures; `frame` is the texture of each frame. If frames are
    /// blended, `blended` is the volume of their G-buffer.
    ///
    /// # Errors
    /// When the shader does not link.
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        textures: &mut ScreenTextures<'_>,
        size: UVec2,
        (frame, blended): (&TextureView, Option<&Gi>),
    ) -> Result<Self, ShaderError> {
        let layout = LayoutBuilder::compute()
            .storage()
            .texture_2d_unfilterable()
            .texture_2d_unfilterable()
            .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT)
            .build(device, "accumulate");
        let kernel =
            Kernel::new(device, shaders, "render::passes::accumulate", "main", &[&layout])?;
        let follow = blended.map(|gi| Follow::new(device, shaders, &layout, gi)).transpose()?;
        let settings = upload(device, "accumulate", &[AccumulateSettings::zeroed()]);
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
        Ok(Self { kernel, follow, settings, means, groups, newest: 0, size, frames: 0, share: 1.0 })
    }

    /// Frames in the mean.
    pub fn frames(&self) -> u32 {
        self.frames
    }

    /// Starts again: the next frame replaces the mean, or is blended with the reprojected mean if
    /// frames are blended.
    pub fn reset(&mut self) {
        if let Some(follow) = &mut self.follow {
            follow.past = (follow.past + self.frames).min(MOVING_FRAMES);
        }
        self.frames = 0;
    }

    /// Starts again without the past frames.
    pub(crate) fn forget(&mut self) {
        self.frames = 0;
        if let Some(follow) = &mut self.follow {
            follow.past = 0;
        }
    }

    /// Sets the index of the next frame in the mean, counted from 0.
    pub(crate) fn number(&mut self, frames: u32) {
        if frames == 0 {
            self.reset();
        }
        self.frames = frames;
    }

    /// Adds the first of a frame's `samples` samples; once per submission. For blended frames, `of`
    /// is the G-buffer, and `true` if light is still changing.
    pub(crate) fn record(
        &mut self,
        recorder: &mut Recorder,
        of: Option<(&GiView, bool)>,
        samples: u32,
    ) {
        let is_relit = u32::from(of.is_some_and(|(_, is_relit)| is_relit));
        self.share = self.weight();
        let weight = weight_of_sample(self.share, 0, samples);
        self.set(recorder, AccumulateSettings { weight, is_relit, padding: [0; 2] });
        let group = &self.groups[self.newest];
        let size = [self.size.x, self.size.y, 1];
        match (&self.follow, of) {
            (Some(Follow { kernel, nothing, past: 1.. }), Some((gbuffer, _)))
                if self.frames == 0 =>
            {
                kernel.run(recorder, &[group, nothing, nothing, gbuffer.group()], size);
            }
            _ => self.kernel.run(recorder, &[group], size),
        }
        self.frames += 1;
    }

    /// Adds a further one of `samples` samples of the newest frame.
    pub(crate) fn record_further(&mut self, recorder: &mut Recorder, sample: u32, samples: u32) {
        let weight = weight_of_sample(self.share, sample, samples);
        self.set(recorder, AccumulateSettings { weight, is_relit: 0, padding: [0; 2] });
        let group = &self.groups[self.newest];
        self.kernel.run(recorder, &[group], [self.size.x, self.size.y, 1]);
    }

    /// Writes the settings and swaps the textures.
    fn set(&mut self, recorder: &Recorder, settings: AccumulateSettings) {
        recorder.queue().write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        self.newest = 1 - self.newest;
    }

    /// Whether the mean includes frames of past pictures.
    pub(crate) fn has_past(&self) -> bool {
        self.follow.as_ref().is_some_and(|follow| follow.past > 0)
    }

    /// The weight of the next frame.
    fn weight(&self) -> f32 {
        let frames = self.frames as f32;
        match &self.follow {
            Some(follow) if self.frames == 0 => 1.0 / (follow.past as f32 + 1.0),
            Some(follow) => 2.0 / (frames + follow.past as f32 + 2.0),
            None => 1.0 / (frames + 1.0),
        }
    }

    /// The mean of the frames so far; undefined before the first.
    pub fn mean(&self) -> &Texture {
        &self.means[self.newest]
    }
}

/// The share of a sample in the new mean. All samples of a frame end up with the same weight,
/// `share` in total.
pub(crate) fn weight_of_sample(share: f32, sample: u32, samples: u32) -> f32 {
    let each = share / samples as f32;
    each / (1.0 - each * (samples - 1 - sample) as f32)
}

impl Follow {
    fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        layout: &wgpu::BindGroupLayout,
        gi: &Gi,
    ) -> Result<Self, ShaderError> {
        let nothing = LayoutBuilder::compute().build(device, "nothing");
        let groups = [layout, &nothing, &nothing, gi.gbuffer_layout()];
        let kernel = Kernel::new(device, shaders, "render::passes::follow", "main", &groups)?;
        let nothing = BindGroupBuilder::new(&nothing).build(device, "nothing");
        Ok(Self { kernel, nothing, past: 0 })
    }
}
