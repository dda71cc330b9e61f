//! Cones from the pixels of a G-buffer: diffuse irradiance, occlusion, glossy reflection.
//!
//! A frame traces one jittered direction in each cell of the hemisphere and one in the glossy lobe;
//! the mean over frames converges to the cones of the settings. With the setting `temporal`, output
//! textures contain the mean of the frames so far; otherwise a single frame, in which adjacent
//! pixels share their light, less with each frame (`share_irradiance.wgsl`).

mod gbuffer;
mod targets;
#[cfg(test)]
pub(crate) mod tests;
mod view;

use std::sync::OnceLock;

use bytemuck::{Pod, Zeroable};
use glam::UVec2;

use crate::GiError;
use crate::cones::{ConeSettings, TraceResolution, TraceSettings};
use crate::emitters::SAMPLES_EMITTERS;
use crate::gpu::{
    BindGroup, Kernel, KernelVariants, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
};
use crate::temporal;

pub(crate) use gbuffer::gbuffer_layout;
pub use gbuffer::{AS_THE_CAMERA, GBuffer, GBufferViews};
#[cfg(test)]
pub(crate) use view::CameraViewUniform;
pub use view::{CameraView, GiView};

/// Format of the outputs.
const OUTPUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of surfaces (`guide.wgsl`) and of reflections in two forms (`reflections.wgsl`).
const WORDS_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Uint;
/// Format of the sample counts.
const SAMPLES_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// Defines the constants that Rust and the shaders of this folder share.
pub(crate) fn add_constants(library: &mut ShaderLibrary) {
    library.constant_f32("AS_THE_CAMERA", AS_THE_CAMERA);
}

/// Rays to emitters of a pixel at full resolution; at half resolution, which is for motion, one.
const EMITTER_RAYS: u32 = 4;

/// `ScreenSettings` of `screen.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ScreenSettings {
    pub(crate) cones: ConeSettings,
    pub(crate) diffuse_cones: u32,
    pub(crate) scale: u32,
    pub(crate) specular_share: f32,
    pub(crate) bounces: u32,
    pub(crate) remembers: u32,
    pub(crate) has_changed: u32,
    pub(crate) turns: u32,
    pub(crate) edge_turns: u32,
    pub(crate) shares: u32,
    pub(crate) emitter_rays: u32,
    padding: [u32; 2],
}

impl ScreenSettings {
    /// The uniforms for tracing a frame.
    pub(crate) fn new(
        (settings, model_values): (&TraceSettings, [f32; 4]),
        resolution: TraceResolution,
        voxel_size_m: f32,
        (bounces, marches): (u32, bool),
    ) -> Self {
        Self {
            cones: settings.cones(voxel_size_m, model_values),
            diffuse_cones: settings.diffuse_cones,
            scale: resolution.scale(),
            // 0 disables glossy cones.
            specular_share: if settings.specular { settings.specular_share } else { 0.0 },
            bounces,
            remembers: 0,
            has_changed: 0,
            turns: 1,
            edge_turns: 1,
            // Marched cones are wide enough that pixels need not share light.
            shares: u32::from(!marches),
            emitter_rays: match resolution {
                TraceResolution::Full => EMITTER_RAYS,
                TraceResolution::Half => 1,
            },
            padding: [0; 2],
        }
    }
}

/// Traces cones from a G-buffer.
#[derive(Debug)]
pub(crate) struct Tracer {
    diffuse: KernelVariants,
    specular: KernelVariants,
    diffuse_layout: wgpu::BindGroupLayout,
    glossy_layout: wgpu::BindGroupLayout,
    count_layout: wgpu::BindGroupLayout,
    specular_layout: wgpu::BindGroupLayout,
    share_irradiance_layout: wgpu::BindGroupLayout,
    share_reflections_layout: wgpu::BindGroupLayout,
    reconstruct_layout: wgpu::BindGroupLayout,
    edges_layout: wgpu::BindGroupLayout,
    temporal: temporal::Layouts,
    /// Lists glossy tiles.
    glossy: Kernel,
    /// Compute the arguments of dispatches over lists of tiles and of pixels.
    count_tiles: Kernel,
    count_pixels: Kernel,
    share_reflections: Kernel,
    /// Created by the first trace without light of earlier frames.
    mean_kernels: OnceLock<MeanKernels>,
    /// `trace::edges`, for irradiance and reflections; created by the first trace at half
    /// resolution.
    edges: OnceLock<[KernelVariants; 2]>,
    /// Created by the first trace with light of earlier frames.
    temporal_kernels: OnceLock<temporal::Kernels>,
}

/// Additional kernels of pictures without light of earlier frames, which callers average.
#[derive(Debug)]
struct MeanKernels {
    share_irradiance: Kernel,
    reconstruct: Kernel,
}

impl Tracer {
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        globals: &wgpu::BindGroupLayout,
        lights: &wgpu::BindGroupLayout,
        gbuffer: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let (d2, uint) = (wgpu::TextureViewDimension::D2, wgpu::TextureSampleType::Uint);
        let diffuse_layout = LayoutBuilder::compute()
            .uniform()
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_texture(d2, SAMPLES_FORMAT)
            .storage_texture(d2, WORDS_FORMAT)
            .build(device, "diffuse cones");
        let glossy_layout = LayoutBuilder::compute()
            .uniform()
            .texture_2d_unfilterable()
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_texture(d2, SAMPLES_FORMAT)
            .storage_texture(d2, WORDS_FORMAT)
            .storage_mut()
            .storage_mut()
            .build(device, "glossy tiles");
        let count_layout =
            LayoutBuilder::compute().storage_mut().storage_mut().build(device, "count");
        let specular_layout = LayoutBuilder::compute()
            .uniform()
            .texture_2d_unfilterable()
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_texture(d2, SAMPLES_FORMAT)
            .storage()
            .build(device, "glossy cones");
        let share_irradiance_layout = LayoutBuilder::compute()
            .uniform()
            .texture(d2, uint)
            .texture_2d_unfilterable()
            .storage_texture(d2, OUTPUT_FORMAT)
            .build(device, "share irradiance");
        let share_reflections_layout = LayoutBuilder::compute()
            .uniform()
            .texture(d2, uint)
            .texture_2d_unfilterable()
            .storage_texture(d2, WORDS_FORMAT)
            .storage()
            .build(device, "share reflections");
        let reconstruct_layout = LayoutBuilder::compute()
            .uniform()
            .texture(d2, uint)
            .texture_2d_unfilterable()
            .texture_2d_unfilterable()
            .texture_2d_unfilterable()
            .texture(d2, uint)
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_mut()
            .storage_mut()
            .build(device, "reconstruct");
        let edges_layout = LayoutBuilder::compute()
            .uniform()
            .storage()
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_texture(d2, OUTPUT_FORMAT)
            .texture_2d_unfilterable()
            .build(device, "edges");
        let kernel = |module, layout| {
            let groups = [globals, layout, lights, gbuffer];
            KernelVariants::new(device, shaders, SAMPLES_EMITTERS, module, "main", &groups)
        };
        let temporal = temporal::Layouts::new(device);
        let unlit = |module, layout| {
            let groups = [globals, layout, &temporal.nothing, gbuffer];
            Kernel::deferred(device, shaders, module, "main", &groups)
        };
        let glossy = unlit("trace::glossy", &glossy_layout)?;
        let count =
            |entry| Kernel::deferred(device, shaders, "trace::count", entry, &[&count_layout]);
        let [count_tiles, count_pixels] = [count("tiles")?, count("pixels")?];
        let share_reflections = unlit("trace::share_reflections", &share_reflections_layout)?;
        Ok(Self {
            diffuse: kernel("trace::diffuse", &diffuse_layout)?,
            specular: kernel("trace::specular", &specular_layout)?,
            glossy,
            count_tiles,
            count_pixels,
            diffuse_layout,
            glossy_layout,
            count_layout,
            specular_layout,
            share_irradiance_layout,
            share_reflections_layout,
            reconstruct_layout,
            edges_layout,
            temporal,
            share_reflections,
            mean_kernels: OnceLock::new(),
            edges: OnceLock::new(),
            temporal_kernels: OnceLock::new(),
        })
    }

    /// Queues for compilation the kernels that geometry with or without emitters needs.
    pub(crate) fn expect(&self, device: &Pipelines, has_emitters: bool, has_reflections: bool) {
        let edges = self.edges.get().into_iter().flatten();
        let specular = has_reflections.then_some(&self.specular);
        for kernel in [&self.diffuse].into_iter().chain(specular).chain(edges) {
            kernel.expect(device, has_emitters);
        }
        let mean = self.mean_kernels.get().into_iter();
        let mean = mean.flat_map(|kernels| [&kernels.share_irradiance, &kernels.reconstruct]);
        let count = self.edges.get().map(|_| &self.count_pixels);
        let always = [&self.glossy, &self.count_tiles, &self.share_reflections];
        for kernel in mean.chain(count).chain(always) {
            kernel.expect(device);
        }
        if let Some(kernels) = self.temporal_kernels.get() {
            kernels.expect(device, has_emitters);
        }
    }

    /// Links the kernels for pictures without light of earlier frames, at their first use.
    pub(crate) fn prepare_mean(
        &self,
        device: &Pipelines,
        shaders: &ShaderLibrary,
        [globals, _, gbuffer]: [&wgpu::BindGroupLayout; 3],
    ) -> Result<(), GiError> {
        if self.mean_kernels.get().is_none() {
            let kernel = |module, layout| {
                let groups = [globals, layout, &self.temporal.nothing, gbuffer];
                Kernel::deferred(device, shaders, module, "main", &groups)
            };
            let _ = self.mean_kernels.set(MeanKernels {
                share_irradiance: kernel("trace::share_irradiance", &self.share_irradiance_layout)?,
                reconstruct: kernel("trace::reconstruct", &self.reconstruct_layout)?,
            });
        }
        Ok(())
    }

    /// Links the kernels of half resolution, at their first use.
    pub(crate) fn prepare_half(
        &self,
        device: &Pipelines,
        shaders: &ShaderLibrary,
        [globals, lights, gbuffer]: [&wgpu::BindGroupLayout; 3],
    ) -> Result<(), GiError> {
        if self.edges.get().is_some() {
            return Ok(());
        }
        let edges = |entry| {
            let groups = [globals, &self.edges_layout, lights, gbuffer];
            KernelVariants::new(device, shaders, SAMPLES_EMITTERS, "trace::edges", entry, &groups)
        };
        let _ = self.edges.set([edges("diffuse")?, edges("specular")?]);
        Ok(())
    }

    /// Links the kernels that use light of earlier frames, at their first use.
    pub(crate) fn prepare_temporal(
        &self,
        device: &Pipelines,
        shaders: &ShaderLibrary,
        layouts: [&wgpu::BindGroupLayout; 3],
    ) -> Result<(), GiError> {
        if self.temporal_kernels.get().is_none() {
            let kernels = temporal::Kernels::new(device, shaders, &self.temporal, layouts)?;
            let _ = self.temporal_kernels.set(kernels);
        }
        Ok(())
    }

    pub(crate) fn run(
        &self,
        recorder: &mut Recorder,
        bound: &Bound<'_>,
        targets: &targets::TraceTargets,
        settings: &ScreenSettings,
    ) {
        let device = recorder.device().clone();
        recorder.stage("trace");
        targets.with_settings(self, &device, |slot| {
            let known = targets.past.as_ref().map(|past| past.known(bound.content));
            // If no light is known yet, more turns are traced.
            let edge_turns = if known.is_some() { temporal::FIRST_TURNS } else { 1 };
            let [remembers, has_changed] = known.unwrap_or_default().map(u32::from);
            let turns = if remembers != 0 { 1 } else { edge_turns };
            let shares = if known.is_some() { 0 } else { settings.shares };
            let own =
                ScreenSettings { remembers, has_changed, turns, edge_turns, shares, ..*settings };
            slot.set(recorder.queue(), &own);
            let group = |own| [bound.globals, own, bound.lights, bound.gbuffer];
            let unlit = |own| [bound.globals, own, &self.temporal.nothing_group, bound.gbuffer];
            let UVec2 { x, y } = targets.traced_size();
            let has_emitters = bound.has_emitters;
            self.diffuse.variant(has_emitters).run(recorder, &group(&slot.diffuse), [x, y, 1]);
            let temporal = targets.past.as_ref().zip(slot.temporal.as_ref());
            let temporal = temporal.zip(self.temporal_kernels.get());
            if let Some(((past, groups), kernels)) = temporal.filter(|_| has_changed != 0) {
                let probes = kernels.trace_probes.variant(has_emitters);
                past.probe(recorder, (kernels, probes), groups, [bound.globals, bound.lights]);
            }
            recorder.clear(&slot.glossy_tiles.counts);
            self.glossy.run(recorder, &unlit(&slot.glossy), [x, y, 1]);
            self.count_tiles.run(recorder, &[&slot.glossy_tiles.count], [1, 1, 1]);
            // Without reflections no tile is glossy, and the kernel is not compiled.
            if settings.specular_share > 0.0 {
                let specular = self.specular.variant(has_emitters);
                slot.glossy_tiles.run(recorder, specular, &group(&slot.specular));
            }
            if shares != 0 || temporal.is_some() {
                let groups = unlit(&slot.share_reflections);
                slot.glossy_tiles.run(recorder, &self.share_reflections, &groups);
            }
            if let Some(edges) = &slot.edges {
                recorder.clear(&edges.pixels.counts);
            }
            if let Some(((past, groups), kernels)) = temporal {
                let reflected = targets.reflected();
                let former = past.former_group(&device, &self.temporal, slot.settings(), reflected);
                let groups_of = [bound.globals, &self.temporal.nothing_group, bound.gbuffer];
                past.blend(recorder, kernels, groups, groups_of, former.as_ref());
            } else if let (Some(own), Some(kernels)) = (&slot.mean, self.mean_kernels.get()) {
                if shares != 0 {
                    let groups = unlit(&own.share_irradiance);
                    kernels.share_irradiance.run(recorder, &groups, [x, y, 1]);
                }
                let UVec2 { x, y } = targets.size();
                kernels.reconstruct.run(recorder, &unlit(&own.reconstruct), [x, y, 1]);
            }
            if let (Some(edges), Some(kernels)) = (&slot.edges, self.edges.get()) {
                self.count_pixels.run(recorder, &[&edges.pixels.count], [1, 1, 1]);
                for kernel in kernels {
                    let groups = group(&edges.edges);
                    edges.pixels.run(recorder, kernel.variant(has_emitters), &groups);
                }
            }
            targets.keep(recorder, bound.content);
        });
    }
}

/// Bind groups that tracing reads.
pub(crate) struct Bound<'a> {
    pub(crate) globals: &'a BindGroup,
    pub(crate) lights: &'a BindGroup,
    pub(crate) gbuffer: &'a BindGroup,
    /// `true` if emitters are listed.
    pub(crate) has_emitters: bool,
    /// Numbers that change whenever the light or surfaces for the cones do.
    pub(crate) content: [u64; 2],
}
