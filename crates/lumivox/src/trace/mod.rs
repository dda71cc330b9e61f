//! Cones from the pixels of a G-buffer: diffuse irradiance, occlusion, glossy reflection.
//!
//! A frame traces one jittered direction in each cell of the hemisphere and one in the glossy lobe; the mean
//! over frames is what the settings describe. Output textures hold a single frame, so that the caller can
//! accumulate, reproject or filter as it likes.

mod gbuffer;

use std::sync::OnceLock;

use bytemuck::{Pod, Zeroable};
use glam::UVec2;

use crate::GiError;
use crate::cones::{ConeSettings, TraceResolution, TraceSettings};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderLibrary,
    Texture, TextureView, storage_buffer, uniform_buffer,
};

#[cfg(test)]
pub(crate) use gbuffer::CameraViewUniform;
pub(crate) use gbuffer::gbuffer_layout;
pub use gbuffer::{CameraView, GBuffer, GBufferViews};

/// The shader modules of this folder.
pub(crate) const MODULES: &[(&str, &str)] = &[
    ("trace::brdf", include_str!("brdf.wgsl")),
    ("trace::coat", include_str!("coat.wgsl")),
    ("trace::diffuse", include_str!("diffuse.wgsl")),
    ("trace::edge_count", include_str!("edge_count.wgsl")),
    ("trace::edges", include_str!("edges.wgsl")),
    ("trace::gbuffer", include_str!("gbuffer.wgsl")),
    ("trace::screen", include_str!("screen.wgsl")),
    ("trace::specular", include_str!("specular.wgsl")),
    ("trace::upsample", include_str!("upsample.wgsl")),
];

/// Format of the outputs.
const OUTPUT_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;
/// Format of the counts of samples.
const SAMPLES_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R32Float;

/// `ScreenSettings` of `screen.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct ScreenSettings {
    pub(crate) cones: ConeSettings,
    pub(crate) diffuse_cones: u32,
    pub(crate) scale: u32,
    pub(crate) specular_share: f32,
    pub(crate) bounces: u32,
}

/// Traces cones from a G-buffer.
#[derive(Debug)]
pub(crate) struct Tracer {
    diffuse: Kernel,
    specular: Kernel,
    diffuse_layout: wgpu::BindGroupLayout,
    specular_layout: wgpu::BindGroupLayout,
    half: Layouts,
    /// Once something was traced at half resolution.
    kernels: OnceLock<HalfKernels>,
}

/// What half resolution binds.
#[derive(Debug)]
struct Layouts {
    upsample: wgpu::BindGroupLayout,
    count: wgpu::BindGroupLayout,
    edges: wgpu::BindGroupLayout,
}

/// What half resolution needs besides.
#[derive(Debug)]
struct HalfKernels {
    upsample: Kernel,
    count: Kernel,
    edges: Kernel,
}

/// What belongs to one size of picture at half resolution.
#[derive(Debug)]
struct HalfTargets {
    upsample: BindGroup,
    count: BindGroup,
    edges: BindGroup,
    /// How many pixels are traced by themselves, and the workgroups for them.
    counts: Buffer,
}

/// Where the workgroups stand in the counts.
const ARGUMENTS_OFFSET: u64 = 4;

/// The textures that cones are traced into, for one size of picture.
#[derive(Debug)]
pub struct TraceTargets {
    /// Irradiance in rgb; in a the share of the hemisphere that is open, weighted by the cosine.
    pub irradiance: TextureView,
    /// Radiance reflected by the glossy lobe towards the camera in rgb, the BRDF included; in a the samples
    /// that the pixel cost, diffuse ones included.
    pub specular: TextureView,
    size: UVec2,
    resolution: TraceResolution,
    traced_size: UVec2,
    settings: Buffer,
    diffuse_group: BindGroup,
    specular_group: BindGroup,
    half: Option<HalfTargets>,
    bytes: u64,
}

impl Tracer {
    pub(crate) fn new(
        device: &Pipelines,
        shaders: &ShaderLibrary,
        globals: &wgpu::BindGroupLayout,
        lights: &wgpu::BindGroupLayout,
        gbuffer: &wgpu::BindGroupLayout,
    ) -> Result<Self, GiError> {
        let d2 = wgpu::TextureViewDimension::D2;
        let diffuse_layout = LayoutBuilder::compute()
            .uniform()
            .storage_texture(d2, OUTPUT_FORMAT)
            .storage_texture(d2, SAMPLES_FORMAT)
            .build(device, "diffuse cones");
        let specular_layout = LayoutBuilder::compute()
            .uniform()
            .texture_2d_unfilterable()
            .storage_texture(d2, OUTPUT_FORMAT)
            .build(device, "glossy cones");
        let half = Layouts {
            upsample: LayoutBuilder::compute()
                .uniform()
                .texture_2d_unfilterable()
                .texture_2d_unfilterable()
                .storage_texture(d2, OUTPUT_FORMAT)
                .storage_texture(d2, OUTPUT_FORMAT)
                .storage_mut()
                .storage_mut()
                .build(device, "upsample"),
            count: LayoutBuilder::compute().storage_mut().storage_mut().build(device, "edge count"),
            edges: LayoutBuilder::compute()
                .uniform()
                .storage()
                .storage_texture(d2, OUTPUT_FORMAT)
                .storage_texture(d2, OUTPUT_FORMAT)
                .build(device, "edges"),
        };
        let kernel = |module, layout| {
            Kernel::new(device, shaders, module, "main", &[globals, layout, lights, gbuffer])
        };
        Ok(Self {
            diffuse: kernel("trace::diffuse", &diffuse_layout)?,
            specular: kernel("trace::specular", &specular_layout)?,
            diffuse_layout,
            specular_layout,
            half,
            kernels: OnceLock::new(),
        })
    }

    /// Links what half resolution needs, at its first use.
    pub(crate) fn prepare_half(
        &self,
        device: &Pipelines,
        shaders: &ShaderLibrary,
        [globals, lights, gbuffer]: [&wgpu::BindGroupLayout; 3],
    ) -> Result<(), GiError> {
        if self.kernels.get().is_some() {
            return Ok(());
        }
        let kernel = |module, layout| {
            Kernel::new(device, shaders, module, "main", &[globals, layout, lights, gbuffer])
        };
        let _ = self.kernels.set(HalfKernels {
            upsample: kernel("trace::upsample", &self.half.upsample)?,
            count: kernel("trace::edge_count", &self.half.count)?,
            edges: kernel("trace::edges", &self.half.edges)?,
        });
        Ok(())
    }

    pub(crate) fn targets(
        &self,
        device: &wgpu::Device,
        size: UVec2,
        resolution: TraceResolution,
    ) -> TraceTargets {
        let scale = resolution.scale();
        let traced_size = UVec2::new(size.x.div_ceil(scale), size.y.div_ceil(scale));
        let mut bytes = 0;
        let mut texture = |label, size: UVec2, format: wgpu::TextureFormat| {
            let pixels = u64::from(size.x) * u64::from(size.y);
            bytes += pixels * u64::from(format.block_copy_size(None).unwrap_or(8));
            let texture = Texture::new(
                device,
                &wgpu::TextureDescriptor {
                    label: Some(label),
                    size: wgpu::Extent3d {
                        width: size.x,
                        height: size.y,
                        depth_or_array_layers: 1,
                    },
                    mip_level_count: 1,
                    sample_count: 1,
                    dimension: wgpu::TextureDimension::D2,
                    format,
                    usage: wgpu::TextureUsages::STORAGE_BINDING
                        | wgpu::TextureUsages::TEXTURE_BINDING
                        | wgpu::TextureUsages::COPY_SRC,
                    view_formats: &[],
                },
            );
            texture.view()
        };
        let irradiance = texture("traced irradiance", traced_size, OUTPUT_FORMAT);
        let specular = texture("traced specular", traced_size, OUTPUT_FORMAT);
        let samples = texture("diffuse samples", traced_size, SAMPLES_FORMAT);
        let full = (scale > 1).then(|| {
            (texture("irradiance", size, OUTPUT_FORMAT), texture("specular", size, OUTPUT_FORMAT))
        });
        let settings = uniform_buffer(device, "screen settings", &ScreenSettings::zeroed());
        let diffuse_group = BindGroupBuilder::new(&self.diffuse_layout)
            .buffer(&settings)
            .view(&irradiance)
            .view(&samples)
            .build(device, "diffuse cones");
        let specular_group = BindGroupBuilder::new(&self.specular_layout)
            .buffer(&settings)
            .view(&samples)
            .view(&specular)
            .build(device, "glossy cones");
        let half = full.as_ref().map(|(full_irradiance, full_specular)| {
            let pixels = u64::from(size.x) * u64::from(size.y);
            // More than 33 million of them no picture has, whatever its size.
            let most = device.limits().max_storage_buffer_binding_size / 4;
            let counts = storage_buffer(device, "edge count", 16);
            let listed = storage_buffer(device, "edges", 4 * (pixels + 1).min(most));
            bytes += counts.size() + listed.size();
            HalfTargets {
                upsample: BindGroupBuilder::new(&self.half.upsample)
                    .buffer(&settings)
                    .view(&irradiance)
                    .view(&specular)
                    .view(full_irradiance)
                    .view(full_specular)
                    .buffer(&counts)
                    .buffer(&listed)
                    .build(device, "upsample"),
                count: BindGroupBuilder::new(&self.half.count)
                    .buffer(&counts)
                    .buffer(&listed)
                    .build(device, "edge count"),
                edges: BindGroupBuilder::new(&self.half.edges)
                    .buffer(&settings)
                    .buffer(&listed)
                    .view(full_irradiance)
                    .view(full_specular)
                    .build(device, "edges"),
                counts,
            }
        });
        let (irradiance, specular) = full.unwrap_or((irradiance, specular));
        TraceTargets {
            irradiance,
            specular,
            size,
            resolution,
            traced_size,
            settings,
            diffuse_group,
            specular_group,
            half,
            bytes,
        }
    }

    pub(crate) fn run(&self, recorder: &mut Recorder, bound: &Bound<'_>, targets: &TraceTargets) {
        let group = |own| [bound.globals, own, bound.lights, &bound.gbuffer.group];
        let UVec2 { x, y } = targets.traced_size;
        recorder.stage("trace");
        self.diffuse.run(recorder, &group(&targets.diffuse_group), [x, y, 1]);
        self.specular.run(recorder, &group(&targets.specular_group), [x, y, 1]);
        if let (Some(half), Some(kernels)) = (&targets.half, self.kernels.get()) {
            let UVec2 { x, y } = targets.size;
            recorder.clear(&half.counts);
            kernels.upsample.run(recorder, &group(&half.upsample), [x, y, 1]);
            kernels.count.run(recorder, &group(&half.count), [1, 1, 1]);
            recorder.compute("trace::edges", |pass| {
                let groups = group(&half.edges);
                kernels.edges.dispatch_indirect(pass, &groups, &half.counts, ARGUMENTS_OFFSET);
            });
        }
    }
}

/// The bind groups that tracing reads from.
pub(crate) struct Bound<'a> {
    pub(crate) globals: &'a BindGroup,
    pub(crate) lights: &'a BindGroup,
    pub(crate) gbuffer: &'a GBuffer,
}

impl TraceTargets {
    /// The picture's width and height in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// Whether the targets are for full or half resolution.
    pub fn resolution(&self) -> TraceResolution {
        self.resolution
    }

    /// Bytes on the GPU.
    pub fn memory(&self) -> u64 {
        self.bytes
    }

    /// Sets what the next frames are traced with; takes effect at the next submission.
    pub(crate) fn set(
        &self,
        queue: &wgpu::Queue,
        (settings, model_values): (&TraceSettings, [f32; 4]),
        voxel_size_m: f32,
        bounces: u32,
    ) {
        let uniform = ScreenSettings {
            cones: settings.cones(voxel_size_m, model_values),
            diffuse_cones: settings.diffuse_cones,
            scale: self.resolution.scale(),
            // Without glossy cones every share is zero.
            specular_share: if settings.specular { settings.specular_share } else { 0.0 },
            bounces,
        };
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&uniform));
    }
}
