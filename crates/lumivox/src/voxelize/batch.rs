//! The triangles of a batch on the GPU, split into work items, with the dispatches that walk over
//! them.

use bytemuck::{Pod, Zeroable};

use super::hook::{Detail, WalkRun};
use super::input::{DrawGroup, DrawRecord, PreparedBatch};
use super::kernels::Kernels;
use crate::gpu::{
    BindGroup, BindGroupBuilder, BoundIndirect, BoundScan, Buffer, ComputePass, Indirect, Kernel,
    Recorder, Run, Staged, Texture, TextureView, storage_buffer, uniform_buffer,
};
use crate::gpu::{Memory, Remedy};
use crate::{GeometryBatch, GiError, SurfaceMaterial, SurfaceTexture};

/// `SplitParams` of `split.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct SplitParams {
    pub triangle_count: u32,
    pub draw_count: u32,
}

/// `SplitCounts` of `split.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct SplitCounts {
    pub items_overflow: u32,
    pub items: u32,
    pub degenerate: u32,
    pub outside: u32,
}

/// `ItemRun` of `items.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(super) struct ItemRun {
    pub first_triangle: u32,
    pub end_triangle: u32,
    pub first_draw: u32,
    pub end_draw: u32,
}

/// Fallbacks for resources that a material or batch does not have.
#[derive(Debug)]
pub(crate) struct Fallbacks {
    white: TextureView,
    sampler: wgpu::Sampler,
    attributes: Buffer,
}

impl Fallbacks {
    /// Creates the fallbacks.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Self {
        let size = wgpu::Extent3d { width: 1, height: 1, depth_or_array_layers: 1 };
        let texture = Texture::new(
            device,
            &wgpu::TextureDescriptor {
                label: Some("white"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            },
        );
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4),
            rows_per_image: Some(1),
        };
        queue.write_texture(texture.as_image_copy(), &[255; 4], layout, size);
        Self {
            white: texture.view(),
            sampler: device.create_sampler(&wgpu::SamplerDescriptor::default()),
            attributes: storage_buffer(device, "no attributes", 16),
        }
    }
}

/// The dispatch of a group.
#[derive(Debug)]
pub(super) struct GroupDispatch {
    run: BindGroup,
    group: DrawGroup,
    textures: [Option<SurfaceTexture>; 3],
}

impl GroupDispatch {
    /// The detail that its kernel samples.
    pub fn detail(&self) -> Detail {
        self.group.detail
    }
}

/// A batch with the work items that its triangles are split into. Bound once; reused as long as
/// only the contents of its draws change.
#[derive(Debug)]
pub(super) struct SplitBatch {
    /// The bound batch, without draws.
    source: GeometryBatch,
    triangle_count: u32,
    draws: Staged,
    draw_count: usize,
    triangles: BindGroup,
    split: BindGroup,
    scan: BoundScan,
    /// Prefix sum of the numbers of items per triangle, with the total at the end.
    pub item_starts: Buffer,
    /// [`SplitCounts`].
    pub counts: Buffer,
    groups: Vec<GroupDispatch>,
    /// Indirect dispatch sizes of the groups.
    indirect: BoundIndirect,
}

impl SplitBatch {
    /// Allocates buffers for the draws and items of a batch.
    pub fn new(
        memory: &mut Memory<'_>,
        kernels: &Kernels,
        fallbacks: &Fallbacks,
        (batch, prepared): (&GeometryBatch, &PreparedBatch),
        materials: &[SurfaceMaterial],
    ) -> Result<Self, GiError> {
        let device = memory.device();
        let layouts = &kernels.layouts;
        let draws = Staged::new(device, "draws", size_of_val(prepared.draws.as_slice()) as u64);
        let triangles = triangles_group(device, &layouts.triangles, fallbacks, batch, &draws);

        let count = u64::from(prepared.triangle_count);
        let item_starts = memory.buffer("item starts", count + 1, 4, Remedy::Batch)?;
        let counts = storage_buffer(device, "split counts", size_of::<SplitCounts>() as u64);
        let params = SplitParams {
            triangle_count: prepared.triangle_count,
            draw_count: prepared.draws.len() as u32,
        };
        let params = uniform_buffer(device, "split parameters", &params);
        let split = BindGroupBuilder::new(&layouts.split)
            .buffer(&params)
            .buffer(&item_starts)
            .buffer(&counts)
            .build(device, "voxelize::split");
        let scan = kernels.scan.bind(device, &item_starts, prepared.triangle_count + 1);
        let runs: Vec<Run> = prepared
            .groups
            .iter()
            .map(|group| Run { first: group.triangles.start, end: group.triangles.end })
            .collect();
        let indirect = kernels.indirect.bind(device, &item_starts, &runs, &counts);
        let dispatch = |group: &DrawGroup| {
            let textures = textures_of(&materials[group.material as usize]);
            GroupDispatch {
                run: run_group(device, &layouts.run, fallbacks, group, &textures),
                group: group.clone(),
                textures: textures.map(Option::<&SurfaceTexture>::cloned),
            }
        };
        Ok(Self {
            source: GeometryBatch { draws: Vec::new(), ..batch.clone() },
            triangle_count: prepared.triangle_count,
            draws,
            draw_count: prepared.draws.len(),
            triangles,
            split,
            scan,
            item_starts,
            counts,
            groups: prepared.groups.iter().map(dispatch).collect(),
            indirect,
        })
    }

    /// `true` if it is bound to the batch's buffers and groups, even if the draws' contents differ.
    pub fn fits(
        &self,
        (batch, prepared): (&GeometryBatch, &PreparedBatch),
        materials: &[SurfaceMaterial],
    ) -> bool {
        let is_same = |own: &GroupDispatch, group: &DrawGroup| {
            let textures = textures_of(&materials[group.material as usize]);
            own.group == (DrawGroup { material: own.group.material, ..group.clone() })
                && own.textures.each_ref().map(Option::as_ref) == textures
        };
        self.triangle_count == prepared.triangle_count
            && self.draw_count == prepared.draws.len()
            && self.source.is_same_but_draws(batch)
            && self.groups.len() == prepared.groups.len()
            && self.groups.iter().zip(&prepared.groups).all(|(own, group)| is_same(own, group))
    }

    /// Uploads the draws, and splits the triangles into items.
    pub fn split(
        &mut self,
        recorder: &mut Recorder<'_>,
        kernels: &Kernels,
        grid: &BindGroup,
        draws: &[DrawRecord],
    ) {
        self.draws.set(recorder, bytemuck::cast_slice(draws));
        recorder.clear(&self.counts);
        let groups = [grid, &self.triangles, &self.split];
        kernels.split.run_linear(recorder, &groups, u64::from(self.triangle_count));
        kernels.scan.run_bound(recorder, &self.scan);
        kernels.indirect.run(recorder, &self.indirect);
    }

    /// Dispatches a walk over the items of all groups with the kernels for their details;
    /// `pass_group` is bind group 2.
    pub fn walk<'k>(
        &self,
        pass: &mut ComputePass<'_>,
        grid: &BindGroup,
        pass_group: &BindGroup,
        choose: impl Fn(&GroupDispatch) -> &'k Kernel,
    ) {
        for (index, group) in self.groups.iter().enumerate() {
            choose(group).dispatch_indirect(
                pass,
                &[grid, &self.triangles, pass_group, &group.run],
                &self.indirect.arguments,
                index as u64 * Indirect::STRIDE,
            );
        }
    }

    /// The runs of triangles that share textures, for a caller's own walk; `own` is bind group 2.
    pub fn runs<'a>(
        &'a self,
        globals: &'a BindGroup,
        own: &'a BindGroup,
    ) -> impl Iterator<Item = WalkRun<'a>> {
        self.groups.iter().map(move |group| WalkRun {
            detail: group.group.detail,
            triangles: group.group.triangles.clone(),
            groups: [globals, &self.triangles, own, &group.run],
        })
    }
}

/// The textures of a material.
pub(crate) fn textures_of(material: &SurfaceMaterial) -> [Option<&SurfaceTexture>; 3] {
    [&material.reflectance_texture, &material.emission_texture, &material.transmission_texture]
        .map(Option::as_ref)
}

/// Bind group of a batch's triangles, for all kernels that load triangles.
pub(crate) fn triangles_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    fallbacks: &Fallbacks,
    batch: &GeometryBatch,
    draws: &Staged,
) -> BindGroup {
    let triangles = BindGroupBuilder::new(layout).buffer(&batch.positions.buffer);
    let triangles = match &batch.attributes {
        Some(attributes) => triangles.buffer(&attributes.buffer),
        None => triangles.buffer(&fallbacks.attributes),
    };
    triangles
        .buffer(&batch.indices.buffer)
        .buffer(draws.buffer())
        .build(device, "voxelize::triangles")
}

/// Bind group of a run of triangles and its textures, for all kernels that sample textures.
pub(crate) fn run_group(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    fallbacks: &Fallbacks,
    group: &DrawGroup,
    textures: &[Option<&SurfaceTexture>; 3],
) -> BindGroup {
    let run = ItemRun {
        first_triangle: group.triangles.start,
        end_triangle: group.triangles.end,
        first_draw: group.draws.start,
        end_draw: group.draws.end,
    };
    let run = uniform_buffer(device, "run of items", &run);
    textures
        .iter()
        .fold(BindGroupBuilder::new(layout).buffer(&run), |builder, texture| match texture {
            Some(texture) => builder.view(&texture.view).sampler(&texture.sampler),
            None => builder.view(&fallbacks.white).sampler(&fallbacks.sampler),
        })
        .build(device, "voxelize::run")
}
