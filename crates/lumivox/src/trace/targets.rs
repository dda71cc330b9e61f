//! The textures that cones are traced into, and bind groups with the settings of each recording.

use bytemuck::Zeroable;
use glam::UVec2;

use super::{OUTPUT_FORMAT, SAMPLES_FORMAT, ScreenSettings, Tracer, WORDS_FORMAT};
use crate::cones::{TraceResolution, TraceSettings};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, Recorder, Slot, Slots, Texture, TextureView,
    storage_buffer, uniform_buffer,
};
use crate::temporal::{self, Past};

/// The textures that cones are traced into, for one size of picture.
#[derive(Debug)]
pub(crate) struct TraceTargets {
    pub(super) irradiance: TextureView,
    pub(super) specular: TextureView,
    pub(super) records: Option<TextureView>,
    /// The textures of `irradiance` and `specular`.
    outputs: [Texture; 2],
    size: UVec2,
    resolution: TraceResolution,
    traced: Traced,
    /// Tiles of traced pixels, with glossy surfaces.
    glossy_tiles: Listed,
    /// Pixels that are traced individually.
    edge_pixels: Listed,
    /// Light of earlier frames; `None` if the settings do not keep it.
    pub(super) past: Option<Past>,
    slots: Slots<TraceSlot>,
    bytes: u64,
}

/// Direct output of the cones, at the traced size.
#[derive(Debug)]
struct Traced {
    size: UVec2,
    irradiance: TextureView,
    specular: TextureView,
    samples: TextureView,
    /// The surfaces of the traced pixels.
    guides: TextureView,
    /// Light shared with the pixels around. With light of earlier frames the irradiance is one
    /// texel.
    shared_irradiance: TextureView,
    reflections: TextureView,
    /// Distance of the reflected surface, in voxels; one texel without light of earlier frames.
    distance: TextureView,
}

fn pixels_of(size: UVec2) -> u64 {
    u64::from(size.x) * u64::from(size.y)
}

/// The number of tiles of 8x8 pixels (`glossy.wgsl`).
fn tiles_of(size: UVec2) -> u64 {
    pixels_of(size.map(|edge| edge.div_ceil(8)))
}

/// A list: its length with the dispatch's workgroups, and the indices of its pixels or tiles.
#[derive(Debug)]
struct Listed {
    counts: Buffer,
    indices: Buffer,
}

impl Listed {
    /// A list of at most `most` indices; the binding limit caps it, at 33 million by default.
    fn new(device: &wgpu::Device, label: &str, most: u64) -> Self {
        let limit = device.limits().max_storage_buffer_binding_size / 4;
        Self {
            counts: storage_buffer(device, label, 16),
            indices: storage_buffer(device, label, 4 * (most + 1).min(limit)),
        }
    }

    /// Bytes of a list of at most `most` indices, without the cap.
    fn bytes(most: u64) -> u64 {
        16 + (4 * (most + 1)).max(16)
    }
}

/// A list, for dispatches over it.
#[derive(Debug)]
pub(super) struct ListSlot {
    pub(super) counts: Buffer,
    /// For the kernel that computes the dispatch's workgroups.
    pub(super) count: BindGroup,
}

impl ListSlot {
    fn new(tracer: &Tracer, device: &wgpu::Device, list: &Listed) -> Self {
        let count = BindGroupBuilder::new(&tracer.count_layout)
            .buffer(&list.counts)
            .buffer(&list.indices)
            .build(device, "count");
        Self { counts: list.counts.clone(), count }
    }

    /// Runs a kernel over the list.
    pub(super) fn run(&self, recorder: &mut Recorder<'_>, kernel: &Kernel, groups: &[&BindGroup]) {
        kernel.run_indirect(recorder, groups, &self.counts, ARGUMENTS_OFFSET);
    }
}

/// Offset of the workgroup counts in a list's counts.
const ARGUMENTS_OFFSET: u64 = 4;

/// The settings of one recording, with their bind groups.
#[derive(Debug)]
pub(super) struct TraceSlot {
    settings: Buffer,
    pub(super) diffuse: BindGroup,
    pub(super) glossy: BindGroup,
    pub(super) glossy_tiles: ListSlot,
    pub(super) specular: BindGroup,
    pub(super) share_reflections: BindGroup,
    /// Without light of earlier frames.
    pub(super) mean: Option<MeanSlot>,
    /// At half resolution.
    pub(super) edges: Option<EdgeSlot>,
    pub(super) temporal: Option<temporal::Groups>,
}

#[derive(Debug)]
pub(super) struct MeanSlot {
    pub(super) share_irradiance: BindGroup,
    pub(super) reconstruct: BindGroup,
}

#[derive(Debug)]
pub(super) struct EdgeSlot {
    pub(super) pixels: ListSlot,
    pub(super) edges: BindGroup,
}

impl Slot for TraceSlot {
    fn is_free(&self) -> bool {
        // Every recording holds this group.
        !self.diffuse.is_held()
    }
}

impl TraceSlot {
    pub(super) fn settings(&self) -> &Buffer {
        &self.settings
    }

    /// Sets the settings of the recording.
    pub(super) fn set(&self, queue: &wgpu::Queue, settings: &ScreenSettings) {
        queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(settings));
    }
}

impl TraceTargets {
    pub(crate) fn new(device: &wgpu::Device, size: UVec2, settings: &TraceSettings) -> Self {
        let scale = settings.resolution.scale();
        let traced_size = UVec2::new(size.x.div_ceil(scale), size.y.div_ceil(scale));
        let mut bytes = 0;
        let mut texture = |label, size: UVec2, format: wgpu::TextureFormat| {
            let pixels = u64::from(size.x) * u64::from(size.y);
            bytes += pixels * u64::from(format.block_copy_size(None).unwrap_or(8));
            Texture::new(
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
                        | wgpu::TextureUsages::COPY_SRC
                        | wgpu::TextureUsages::COPY_DST,
                    view_formats: &[],
                },
            )
        };
        let traced = [
            texture("traced irradiance", traced_size, OUTPUT_FORMAT),
            texture("traced specular", traced_size, OUTPUT_FORMAT),
        ];
        let samples = texture("diffuse samples", traced_size, SAMPLES_FORMAT).view();
        let guides = texture("traced surfaces", traced_size, WORDS_FORMAT).view();
        let reflections = texture("shared reflections", traced_size, WORDS_FORMAT).view();
        let (shared_size, reflected_size) =
            if settings.temporal { (UVec2::ONE, traced_size) } else { (traced_size, UVec2::ONE) };
        let shared_irradiance = texture("shared irradiance", shared_size, OUTPUT_FORMAT).view();
        let distance = texture("reflected distance", reflected_size, SAMPLES_FORMAT).view();
        let outputs =
            [texture("irradiance", size, OUTPUT_FORMAT), texture("specular", size, OUTPUT_FORMAT)];
        let sizes = (size, traced_size);
        let past = settings.temporal.then(|| Past::new(device, sizes, &mut texture));
        let pixels = if scale > 1 { pixels_of(size) } else { 0 };
        let glossy_tiles = Listed::new(device, "glossy tiles", tiles_of(traced_size));
        let edge_pixels = Listed::new(device, "edges", pixels);
        for list in [&glossy_tiles, &edge_pixels] {
            bytes += list.counts.size() + list.indices.size();
        }
        bytes += if settings.temporal { temporal::probe_bytes(traced_size) } else { 0 };
        let [irradiance, specular] = traced.map(|texture| texture.view());
        Self {
            irradiance: outputs[0].view(),
            specular: outputs[1].view(),
            records: past.as_ref().map(Past::records),
            outputs,
            size,
            resolution: settings.resolution,
            traced: Traced {
                size: traced_size,
                irradiance,
                specular,
                samples,
                guides,
                shared_irradiance,
                reflections,
                distance,
            },
            glossy_tiles,
            edge_pixels,
            past,
            slots: Slots::default(),
            bytes,
        }
    }

    /// GPU memory in bytes of targets with this size, computed without creating them.
    pub fn bytes(size: UVec2, settings: &TraceSettings) -> u64 {
        let scale = settings.resolution.scale();
        let traced_size = size.map(|edge| edge.div_ceil(scale));
        let [pixels, traced] = [size, traced_size].map(pixels_of);
        // `cones`: the cones' two pictures, sample counts, surfaces and shared reflections;
        // `outputs`: the results at the size of the picture.
        let cones = 52 * traced;
        let outputs = 16 * pixels;
        let edge_pixels = if scale > 1 { pixels } else { 0 };
        let listed = Listed::bytes(tiles_of(traced_size)) + Listed::bytes(edge_pixels);
        let past = if settings.temporal {
            temporal::past_bytes(pixels, traced_size) + 4 * traced + 8
        } else {
            8 * traced + 4
        };
        cones + outputs + listed + past
    }

    /// Discards the light of earlier frames.
    pub fn forget(&self) {
        if let Some(past) = &self.past {
            past.forget();
        }
    }

    /// Continues with the light of earlier frames from targets of another size.
    pub fn take_past(&self, former: &Self) {
        if let (Some(past), Some(former)) = (&self.past, &former.past) {
            past.take(former);
        }
    }

    /// `true` if light of earlier frames is kept.
    pub fn is_temporal(&self) -> bool {
        self.past.is_some()
    }

    /// The picture's width and height in pixels.
    pub fn size(&self) -> UVec2 {
        self.size
    }

    /// The resolution of the traces.
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

    /// Distances of reflected surfaces, and the surfaces of the traced pixels.
    pub(super) fn reflected(&self) -> [&TextureView; 2] {
        [&self.traced.distance, &self.traced.guides]
    }

    /// Calls `record` with settings that no other recording uses.
    pub(super) fn with_settings<R>(
        &self,
        tracer: &Tracer,
        device: &wgpu::Device,
        record: impl FnOnce(&TraceSlot) -> R,
    ) -> R {
        self.slots.with_free(|| self.slot(tracer, device), |slot| record(slot))
    }

    /// Keeps the frame's light for the next one.
    pub(super) fn keep(&self, recorder: &mut Recorder, content: [u64; 2]) {
        if let Some(past) = &self.past {
            past.keep(recorder, self.outputs.each_ref(), content);
        }
    }

    fn slot(&self, tracer: &Tracer, device: &wgpu::Device) -> TraceSlot {
        let Traced {
            irradiance,
            specular,
            samples,
            guides,
            shared_irradiance,
            reflections,
            distance,
            ..
        } = &self.traced;
        let Listed { counts, indices: listed } = &self.edge_pixels;
        let settings = uniform_buffer(device, "screen settings", &ScreenSettings::zeroed());
        let mean = self.past.is_none().then(|| MeanSlot {
            share_irradiance: BindGroupBuilder::new(&tracer.share_irradiance_layout)
                .buffer(&settings)
                .view(guides)
                .view(irradiance)
                .view(shared_irradiance)
                .build(device, "share irradiance"),
            reconstruct: BindGroupBuilder::new(&tracer.reconstruct_layout)
                .buffer(&settings)
                .view(guides)
                .view(irradiance)
                .view(specular)
                .view(shared_irradiance)
                .view(reflections)
                .view(&self.irradiance)
                .view(&self.specular)
                .buffer(counts)
                .buffer(listed)
                .build(device, "reconstruct"),
        });
        let edges = (self.resolution == TraceResolution::Half).then(|| EdgeSlot {
            pixels: ListSlot::new(tracer, device, &self.edge_pixels),
            edges: BindGroupBuilder::new(&tracer.edges_layout)
                .buffer(&settings)
                .buffer(listed)
                .view(&self.irradiance)
                .view(&self.specular)
                .view(samples)
                .build(device, "edges"),
        });
        let outputs = self.outputs.each_ref();
        let traced =
            temporal::Traced { irradiance, guides, reflections, distance, outputs, counts, listed };
        let temporal = self
            .past
            .as_ref()
            .map(|past| past.groups(device, &tracer.temporal, &settings, &traced));
        TraceSlot {
            diffuse: BindGroupBuilder::new(&tracer.diffuse_layout)
                .buffer(&settings)
                .view(irradiance)
                .view(samples)
                .view(guides)
                .build(device, "diffuse cones"),
            glossy: BindGroupBuilder::new(&tracer.glossy_layout)
                .buffer(&settings)
                .view(samples)
                .view(specular)
                .view(distance)
                .view(reflections)
                .buffer(&self.glossy_tiles.counts)
                .buffer(&self.glossy_tiles.indices)
                .build(device, "glossy tiles"),
            glossy_tiles: ListSlot::new(tracer, device, &self.glossy_tiles),
            specular: BindGroupBuilder::new(&tracer.specular_layout)
                .buffer(&settings)
                .view(samples)
                .view(specular)
                .view(distance)
                .buffer(&self.glossy_tiles.indices)
                .build(device, "glossy cones"),
            share_reflections: BindGroupBuilder::new(&tracer.share_reflections_layout)
                .buffer(&settings)
                .view(guides)
                .view(specular)
                .view(reflections)
                .buffer(&self.glossy_tiles.indices)
                .build(device, "share reflections"),
            mean,
            edges,
            temporal,
            settings,
        }
    }

    /// Number of slots: the maximum number of recordings that were in progress at once.
    #[cfg(test)]
    pub(super) fn slot_count(&self) -> usize {
        self.slots.count()
    }

    /// `true` if no recording is in progress.
    #[cfg(test)]
    pub(super) fn are_slots_free(&self) -> bool {
        self.slots.are_free()
    }
}
