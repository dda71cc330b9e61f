//! Light of earlier frames, reprojected with its surfaces.
//!
//! A single frame has the noise of a few cones a pixel. Gathered light belongs to a surface, not to
//! a pixel, so it is looked up at the surface's place in the previous frame, and the new light is
//! blended into it. A filter over many pixels separates change from noise, and changes are applied
//! at once. The filter also provides light for pixels without known light: after a cut, and on
//! newly visible surfaces.
//!
//! | step | for each | file |
//! | --- | --- | --- |
//! | change of the light where it was | probe | `trace_probes.wgsl`, `drift.wgsl` |
//! | known light of the surface | pixel | `recall.wgsl`, `reflection.wgsl`, `past.wgsl` |
//! | comparison with this frame's light | traced pixel | `compare.wgsl` |
//! | a wide filter in four steps | traced pixel | `filter.wgsl` |
//! | blend of both, for the picture and the next frame | pixel | `resolve.wgsl`, `blend.wgsl` |
//! | sample traced pixels, for the next frame | probe | `take_probes.wgsl` |
//!
//! Reflections are looked up at the previous place of their mirror image, which moves differently
//! from the surface.
//!
//! Only light gathered by cones is reused. Direct light has no noise, and must not lag.

use std::sync::{Mutex, PoisonError};

use glam::UVec2;

use crate::emitters::SAMPLES_EMITTERS;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, KernelVariants, LayoutBuilder, Pipelines,
    Recorder, ShaderError, ShaderLibrary, Texture, TextureView, storage_buffer, uniform_buffer,
};

const LIGHT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
const GUIDE: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;
const RECORD: wgpu::TextureFormat = wgpu::TextureFormat::Rg32Uint;

/// Distance between the pixels of each filter step.
const FILTER_STEPS: [u32; 4] = [1, 2, 4, 8];

/// Stride of `FilterStep` (`filter.wgsl`) in its buffer: the offset alignment of uniforms.
const STEP_BYTES: u64 = 256;

/// Jitter turns that a pixel traces in a frame without known light; four of them halve the noise.
pub(crate) const FIRST_TURNS: u32 = 4;

/// Spacing of probes, in traced pixels.
const PROBE_SPACING: u32 = 3;
/// Bytes of `Probe` of `probe.wgsl`.
const PROBE_BYTES: u64 = 80;

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library.constant_u32("PROBE_SPACING", PROBE_SPACING);
}

/// Bytes of a [`Past`] for a picture with this number of pixels.
pub(crate) fn past_bytes(pixels: u64, traced_size: UVec2) -> u64 {
    let traced = u64::from(traced_size.x) * u64::from(traced_size.y);
    // First term: kept, recalled and records; second: guides, light, change and drift.
    48 * pixels + 88 * traced + probe_bytes(traced_size)
}

/// Bytes of the probes of a picture with this many traced pixels along each edge.
pub(crate) fn probe_bytes(traced_size: UVec2) -> u64 {
    let probes = traced_size.map(|pixels| pixels.div_ceil(PROBE_SPACING));
    u64::from(probes.x) * u64::from(probes.y) * PROBE_BYTES
}

/// The layouts of the steps.
#[derive(Debug)]
pub(crate) struct Layouts {
    trace_probes: wgpu::BindGroupLayout,
    drift: wgpu::BindGroupLayout,
    take_probes: wgpu::BindGroupLayout,
    recall: wgpu::BindGroupLayout,
    compare: wgpu::BindGroupLayout,
    filter: wgpu::BindGroupLayout,
    resolve: wgpu::BindGroupLayout,
    /// An empty layout in place of the lights, which only cones read, and its bind group.
    pub(crate) nothing: wgpu::BindGroupLayout,
    pub(crate) nothing_group: BindGroup,
}

impl Layouts {
    pub(crate) fn new(device: &Pipelines) -> Self {
        let d2 = wgpu::TextureViewDimension::D2;
        let uint = wgpu::TextureSampleType::Uint;
        let nothing = LayoutBuilder::compute().build(device, "nothing");
        Self {
            nothing_group: BindGroupBuilder::new(&nothing).build(device, "nothing"),
            nothing,
            recall: LayoutBuilder::compute()
                .uniform()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .texture(d2, uint)
                .storage_texture(d2, LIGHT)
                .storage_texture(d2, LIGHT)
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .texture(d2, uint)
                .build(device, "recall"),
            trace_probes: LayoutBuilder::compute()
                .uniform()
                .storage_mut()
                .build(device, "trace probes"),
            drift: LayoutBuilder::compute()
                .texture_2d_unfilterable()
                .storage()
                .storage_texture(d2, LIGHT)
                .storage_texture(d2, LIGHT)
                .build(device, "drift"),
            take_probes: LayoutBuilder::compute()
                .uniform()
                .texture_2d_unfilterable()
                .storage_mut()
                .build(device, "take probes"),
            compare: LayoutBuilder::compute()
                .uniform()
                .texture(d2, uint)
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .storage_texture(d2, GUIDE)
                .storage_texture(d2, LIGHT)
                .storage_texture(d2, LIGHT)
                .build(device, "compare"),
            filter: LayoutBuilder::compute()
                .uniform()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .storage_texture(d2, LIGHT)
                .storage_texture(d2, LIGHT)
                .build(device, "filter"),
            resolve: (0..7)
                .fold(
                    LayoutBuilder::compute().uniform().texture(d2, uint).texture(d2, uint),
                    |layout, _| layout.texture_2d_unfilterable(),
                )
                .storage_texture(d2, LIGHT)
                .storage_texture(d2, LIGHT)
                .storage_texture(d2, RECORD)
                .storage_mut()
                .storage_mut()
                .build(device, "resolve"),
        }
    }
}

/// The kernels of the steps.
#[derive(Debug)]
pub(crate) struct Kernels {
    pub(crate) trace_probes: KernelVariants,
    drift: Kernel,
    take_probes: Kernel,
    recall: Kernel,
    compare: Kernel,
    filter: Kernel,
    resolve: Kernel,
}

impl Kernels {
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        layouts: &Layouts,
        [globals, lights, gbuffer]: [&wgpu::BindGroupLayout; 3],
    ) -> Result<Self, ShaderError> {
        let kernel = |module: &str, own| {
            let module = format!("temporal::{module}");
            let groups = [globals, own, &layouts.nothing, gbuffer];
            Kernel::deferred(device, shaders, &module, "main", &groups)
        };
        let probes = [globals, &layouts.trace_probes, lights];
        let trace_probes = KernelVariants::new(
            device,
            shaders,
            SAMPLES_EMITTERS,
            "temporal::trace_probes",
            "main",
            &probes,
        )?;
        let drift = [globals, &layouts.drift];
        let filter = [globals, &layouts.filter];
        Ok(Self {
            trace_probes,
            drift: Kernel::deferred(device, shaders, "temporal::drift", "main", &drift)?,
            take_probes: kernel("take_probes", &layouts.take_probes)?,
            recall: kernel("recall", &layouts.recall)?,
            compare: kernel("compare", &layouts.compare)?,
            filter: Kernel::deferred(device, shaders, "temporal::filter", "main", &filter)?,
            resolve: kernel("resolve", &layouts.resolve)?,
        })
    }

    /// Queues for compilation the kernels that geometry with or without emitters needs.
    pub(crate) fn expect(&self, device: &Pipelines, has_emitters: bool) {
        self.trace_probes.expect(device, has_emitters);
        let Self { drift, take_probes, recall, compare, filter, resolve, .. } = self;
        for kernel in [drift, take_probes, recall, compare, filter, resolve] {
            kernel.expect(device);
        }
    }
}

/// Textures and buffers of a frame.
#[derive(Debug)]
pub(crate) struct Traced<'a> {
    /// Output of the cones, at the traced size.
    pub(crate) irradiance: &'a TextureView,
    /// The surfaces of the traced pixels.
    pub(crate) guides: &'a TextureView,
    pub(crate) reflections: &'a TextureView,
    /// Distance of the reflected surface.
    pub(crate) distance: &'a TextureView,
    /// The outputs, at the size of the picture.
    pub(crate) outputs: [&'a Texture; 2],
    /// Pixels that are traced individually.
    pub(crate) counts: &'a Buffer,
    pub(crate) listed: &'a Buffer,
}

/// Light of earlier frames of one picture.
#[derive(Debug)]
pub(crate) struct Past {
    size: UVec2,
    traced_size: UVec2,
    /// Irradiance and reflection of the last frame, and the records of its surfaces.
    kept: [Texture; 3],
    /// Records of this frame.
    records: Texture,
    recalled: [Texture; 2],
    guide: Texture,
    /// The frame's light, and its light after each step of the filter.
    light: [Texture; 5],
    change: [Texture; 2],
    steps: Buffer,
    probes: Buffer,
    /// Old and new filtered light of the probes.
    drift: [Texture; 2],
    seen: Mutex<Seen>,
}

/// The source of known light for the next frame.
#[derive(Clone, Debug)]
enum Seen {
    Nothing,
    /// The textures kept by targets of another size.
    Former([Texture; 3]),
    /// The last frame; the numbers identify the content that its cones saw.
    Frame([u64; 2]),
}

/// The bind groups of the steps.
#[derive(Debug)]
pub(crate) struct Groups {
    trace_probes: BindGroup,
    drift: BindGroup,
    take_probes: BindGroup,
    recall: BindGroup,
    compare: BindGroup,
    filters: [BindGroup; 4],
    resolve: BindGroup,
}

impl Past {
    /// `make` creates a texture with the name, size and format.
    pub(crate) fn new(
        device: &wgpu::Device,
        (size, traced_size): (UVec2, UVec2),
        mut make: impl FnMut(&'static str, UVec2, wgpu::TextureFormat) -> Texture,
    ) -> Self {
        let steps = FILTER_STEPS.map(|step| {
            let mut words = [0_u32; STEP_BYTES as usize / 4];
            words[0] = step;
            words
        });
        Self {
            size,
            traced_size,
            kept: [("past irradiance", LIGHT), ("past specular", LIGHT), ("past records", RECORD)]
                .map(|(label, format)| make(label, size, format)),
            records: make("records", size, RECORD),
            recalled: ["recalled irradiance", "recalled specular"]
                .map(|label| make(label, size, LIGHT)),
            guide: make("guide", traced_size, GUIDE),
            light: [(); 5].map(|()| make("filtered light", traced_size, LIGHT)),
            change: [(); 2].map(|()| make("filtered change", traced_size, LIGHT)),
            steps: uniform_buffer(device, "filter steps", &steps),
            probes: storage_buffer(device, "probes", probe_bytes(traced_size)),
            drift: ["probes were", "probes are"].map(|label| make(label, traced_size, LIGHT)),
            seen: Mutex::new(Seen::Nothing),
        }
    }

    /// Discards the light of earlier frames.
    pub(crate) fn forget(&self) {
        self.see(Seen::Nothing);
    }

    /// Makes the next frame recall the light of `former`.
    pub(crate) fn take(&self, former: &Self) {
        self.see(match former.seen() {
            Seen::Frame(_) => Seen::Former(former.kept.clone()),
            taken => taken,
        });
    }

    /// Whether the next frame has known light, and whether `content` has changed since the last
    /// frame.
    pub(crate) fn known(&self, content: [u64; 2]) -> [bool; 2] {
        match self.seen() {
            Seen::Nothing => [false, false],
            // Probes are not kept across a resize.
            Seen::Former(_) => [true, false],
            Seen::Frame(seen) => [true, seen != content],
        }
    }

    /// The records of the last frame.
    pub(crate) fn records(&self) -> TextureView {
        self.records.view()
    }

    fn seen(&self) -> Seen {
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).clone()
    }

    fn see(&self, seen: Seen) {
        *self.seen.lock().unwrap_or_else(PoisonError::into_inner) = seen;
    }

    pub(crate) fn groups(
        &self,
        device: &wgpu::Device,
        layouts: &Layouts,
        settings: &Buffer,
        traced: &Traced<'_>,
    ) -> Groups {
        let views = |textures: &[Texture]| -> Vec<TextureView> {
            textures.iter().map(Texture::view).collect()
        };
        let recalled = views(&self.recalled);
        let (light, change) = (views(&self.light), views(&self.change));
        let (guide, records) = (self.guide.view(), self.records.view());
        let drift = views(&self.drift);
        let filters = std::array::from_fn(|step| {
            BindGroupBuilder::new(&layouts.filter)
                .slice(&self.steps, step as u64 * STEP_BYTES, 16)
                .view(&guide)
                .view(&light[step])
                .view(&change[step % 2])
                .view(&light[step + 1])
                .view(&change[1 - step % 2])
                .build(device, "filter")
        });
        let outputs = traced.outputs.map(Texture::view);
        let reflected = [traced.distance, traced.guides];
        Groups {
            recall: self.recall_group(device, layouts, settings, &self.kept, reflected),
            trace_probes: BindGroupBuilder::new(&layouts.trace_probes)
                .buffer(settings)
                .buffer(&self.probes)
                .build(device, "trace probes"),
            drift: BindGroupBuilder::new(&layouts.drift)
                .view(&guide)
                .buffer(&self.probes)
                .view(&drift[0])
                .view(&drift[1])
                .build(device, "drift"),
            take_probes: BindGroupBuilder::new(&layouts.take_probes)
                .buffer(settings)
                .view(traced.irradiance)
                .buffer(&self.probes)
                .build(device, "take probes"),
            compare: BindGroupBuilder::new(&layouts.compare)
                .buffer(settings)
                .view(traced.guides)
                .view(traced.irradiance)
                .view(&recalled[0])
                .view(&recalled[1])
                .view(&guide)
                .view(&light[0])
                .view(&change[0])
                .build(device, "compare"),
            filters,
            resolve: BindGroupBuilder::new(&layouts.resolve)
                .buffer(settings)
                .view(traced.guides)
                .view(traced.reflections)
                .view(traced.irradiance)
                .view(&light[1])
                .view(&light[2])
                .view(&light[4])
                .view(&change[0])
                .view(&recalled[0])
                .view(&recalled[1])
                .view(&outputs[0])
                .view(&outputs[1])
                .view(&records)
                .buffer(traced.counts)
                .buffer(traced.listed)
                .build(device, "resolve"),
        }
    }

    fn recall_group(
        &self,
        device: &wgpu::Device,
        layouts: &Layouts,
        settings: &Buffer,
        kept: &[Texture; 3],
        [distance, guides]: [&TextureView; 2],
    ) -> BindGroup {
        let textures = kept.iter().chain(&self.recalled).chain([&self.guide]).chain(&self.drift);
        let views: Vec<TextureView> = textures.map(Texture::view).collect();
        let mut group = BindGroupBuilder::new(&layouts.recall).buffer(settings);
        for view in &views {
            group = group.view(view);
        }
        group.view(distance).view(guides).build(device, "recall")
    }

    /// Bind group for recalling light of another size; `None` if the known light has the same size.
    /// `reflected` has the distances of reflected surfaces and the surfaces of the traced pixels.
    pub(crate) fn former_group(
        &self,
        device: &wgpu::Device,
        layouts: &Layouts,
        settings: &Buffer,
        reflected: [&TextureView; 2],
    ) -> Option<BindGroup> {
        let Seen::Former(kept) = self.seen() else { return None };
        Some(self.recall_group(device, layouts, settings, &kept, reflected))
    }

    /// Retraces the last frame's probes in the light of this frame.
    pub(crate) fn probe(
        &self,
        recorder: &mut Recorder,
        (kernels, trace_probes): (&Kernels, &Kernel),
        groups: &Groups,
        [globals, lights]: [&BindGroup; 2],
    ) {
        let UVec2 { x, y } = self.probes();
        let again = [globals, &groups.trace_probes, lights];
        trace_probes.run_linear(recorder, &again, u64::from(x) * u64::from(y));
        let traced = [self.traced_size.x, self.traced_size.y, 1];
        kernels.drift.run(recorder, &[globals, &groups.drift], traced);
    }

    /// The size of the table of probes.
    fn probes(&self) -> UVec2 {
        self.traced_size.map(|pixels| pixels.div_ceil(PROBE_SPACING))
    }

    /// Blends the traced frame into the known light, lists the pixels that have to be traced
    /// individually, and samples probes for the next frame.
    pub(crate) fn blend(
        &self,
        recorder: &mut Recorder,
        kernels: &Kernels,
        groups: &Groups,
        [globals, nothing, gbuffer]: [&BindGroup; 3],
        former: Option<&BindGroup>,
    ) {
        let UVec2 { x, y } = self.size;
        let traced = [self.traced_size.x, self.traced_size.y, 1];
        let probes = self.probes();
        let with = |own| [globals, own, nothing, gbuffer];
        let recall = former.unwrap_or(&groups.recall);
        kernels.recall.run(recorder, &with(recall), [x, y, 1]);
        kernels.compare.run(recorder, &with(&groups.compare), traced);
        for filter in &groups.filters {
            kernels.filter.run(recorder, &[globals, filter], traced);
        }
        kernels.resolve.run(recorder, &with(&groups.resolve), [x, y, 1]);
        kernels.take_probes.run(recorder, &with(&groups.take_probes), [probes.x, probes.y, 1]);
    }

    /// Keeps the frame for the next one. Call it after its outputs are complete.
    pub(crate) fn keep(&self, recorder: &mut Recorder, outputs: [&Texture; 2], content: [u64; 2]) {
        let [irradiance, specular] = outputs;
        for (from, to) in [irradiance, specular, &self.records].into_iter().zip(&self.kept) {
            recorder.copy_texture(from, to);
        }
        self.see(Seen::Frame(content));
    }
}
