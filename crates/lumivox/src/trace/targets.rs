//! What cones are traced into, and the bind groups with the settings of each recording.

use bytemuck::Zeroable;
use glam::UVec2;

use super::{OUTPUT_FORMAT, SAMPLES_FORMAT, ScreenSettings, Tracer};
use crate::cones::TraceResolution;
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Slot, Slots, Texture, TextureView, storage_buffer,
    uniform_buffer,
};

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
    traced: Traced,
    half: Option<Half>,
    slots: Slots<TraceSlot>,
    bytes: u64,
}

/// What the cones themselves write, at the traced size.
#[derive(Debug)]
struct Traced {
    size: UVec2,
    irradiance: TextureView,
    specular: TextureView,
    samples: TextureView,
}

/// What half resolution writes besides: how many pixels are traced by themselves with the workgroups for them, and
/// which.
#[derive(Debug)]
struct Half {
    counts: Buffer,
    listed: Buffer,
}

/// The settings of one recording, bound.
#[derive(Debug)]
pub(super) struct TraceSlot {
    settings: Buffer,
    pub(super) diffuse: BindGroup,
    pub(super) specular: BindGroup,
    pub(super) half: Option<HalfSlot>,
}

#[derive(Debug)]
pub(super) struct HalfSlot {
    pub(super) upsample: BindGroup,
    pub(super) count: BindGroup,
    pub(super) edges: BindGroup,
    pub(super) counts: Buffer,
}

impl Slot for TraceSlot {
    fn is_free(&self) -> bool {
        // Every recording has the diffuse cones.
        !self.diffuse.is_held()
    }
}

impl TraceSlot {
    /// Sets what the recording is traced with.
    pub(super) fn set(&self, queue: &wgpu::Queue, settings: &ScreenSettings) {
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(settings));
    }
}

impl TraceTargets {
    pub(crate) fn new(device: &wgpu::Device, size: UVec2, resolution: TraceResolution) -> Self {
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
        let traced = Traced {
            size: traced_size,
            irradiance: texture("traced irradiance", traced_size, OUTPUT_FORMAT),
            specular: texture("traced specular", traced_size, OUTPUT_FORMAT),
            samples: texture("diffuse samples", traced_size, SAMPLES_FORMAT),
        };
        let (irradiance, specular) = if scale > 1 {
            (texture("irradiance", size, OUTPUT_FORMAT), texture("specular", size, OUTPUT_FORMAT))
        } else {
            (traced.irradiance.clone(), traced.specular.clone())
        };
        let half = (scale > 1).then(|| {
            let pixels = u64::from(size.x) * u64::from(size.y);
            // More than 33 million of them no picture has, whatever its size.
            let most = device.limits().max_storage_buffer_binding_size / 4;
            let counts = storage_buffer(device, "edge count", 16);
            let listed = storage_buffer(device, "edges", 4 * (pixels + 1).min(most));
            bytes += counts.size() + listed.size();
            Half { counts, listed }
        });
        let slots = Slots::default();
        Self { irradiance, specular, size, resolution, traced, half, slots, bytes }
    }

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

    pub(super) fn traced_size(&self) -> UVec2 {
        self.traced.size
    }

    /// Records with settings that no other recording sees.
    pub(super) fn with_settings<R>(
        &self,
        tracer: &Tracer,
        device: &wgpu::Device,
        record: impl FnOnce(&TraceSlot) -> R,
    ) -> R {
        self.slots.with_free(|| self.slot(tracer, device), |slot| record(slot))
    }

    fn slot(&self, tracer: &Tracer, device: &wgpu::Device) -> TraceSlot {
        let Traced { irradiance, specular, samples, .. } = &self.traced;
        let settings = uniform_buffer(device, "screen settings", &ScreenSettings::zeroed());
        let half = self.half.as_ref().map(|Half { counts, listed }| HalfSlot {
            upsample: BindGroupBuilder::new(&tracer.half.upsample)
                .buffer(&settings)
                .view(irradiance)
                .view(specular)
                .view(&self.irradiance)
                .view(&self.specular)
                .buffer(counts)
                .buffer(listed)
                .build(device, "upsample"),
            count: BindGroupBuilder::new(&tracer.half.count)
                .buffer(counts)
                .buffer(listed)
                .build(device, "edge count"),
            edges: BindGroupBuilder::new(&tracer.half.edges)
                .buffer(&settings)
                .buffer(listed)
                .view(&self.irradiance)
                .view(&self.specular)
                .build(device, "edges"),
            counts: counts.clone(),
        });
        TraceSlot {
            diffuse: BindGroupBuilder::new(&tracer.diffuse_layout)
                .buffer(&settings)
                .view(irradiance)
                .view(samples)
                .build(device, "diffuse cones"),
            specular: BindGroupBuilder::new(&tracer.specular_layout)
                .buffer(&settings)
                .view(samples)
                .view(specular)
                .build(device, "glossy cones"),
            half,
            settings,
        }
    }

    /// How many recordings were under way at once.
    #[cfg(test)]
    pub(super) fn slot_count(&self) -> usize {
        self.slots.count()
    }
}
