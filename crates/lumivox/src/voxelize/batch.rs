//! The triangles of a batch on the GPU, cut into work items, with the dispatches that walk over them.

use bytemuck::{Pod, Zeroable};

use super::hook::{Detail, WalkRun};
use super::input::{DrawGroup, PreparedBatch};
use super::kernels::{Kernels, Layouts};
use crate::gpu::{
    BindGroup, BindGroupBuilder, Buffer, ComputePass, Indirect, Kernel, Recorder, Run, Texture,
    TextureView, storage_buffer, uniform_buffer, upload,
};
use crate::gpu::{Memory, Remedy};
use crate::{GeometryBatch, GiError, SurfaceMaterial};

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

/// Stand-ins for what a material or batch does not have.
#[derive(Debug)]
pub(super) struct Fallbacks {
    white: TextureView,
    sampler: wgpu::Sampler,
    attributes: Buffer,
}

impl Fallbacks {
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

/// A group's dispatch.
#[derive(Debug)]
pub(super) struct GroupDispatch {
    run: BindGroup,
    triangles: std::ops::Range<u32>,
    /// What there is to sample.
    pub detail: Detail,
}

/// A batch, split into items.
#[derive(Debug)]
pub(super) struct SplitBatch {
    triangles: BindGroup,
    /// Prefix sum of the items of the triangles, with the total last.
    pub item_starts: Buffer,
    /// [`SplitCounts`].
    pub counts: Buffer,
    groups: Vec<GroupDispatch>,
    /// Workgroups for each group.
    arguments: Buffer,
}

impl SplitBatch {
    /// Uploads the draws and splits the triangles into items.
    pub fn new(
        recorder: &mut Recorder,
        memory: &mut Memory<'_>,
        kernels: &Kernels,
        grid: &BindGroup,
        fallbacks: &Fallbacks,
        (batch, prepared): (&GeometryBatch, &PreparedBatch),
        materials: &[SurfaceMaterial],
    ) -> Result<Self, GiError> {
        let device = memory.device();
        let layouts = &kernels.layouts;
        let draws = upload(device, "draws", &prepared.draws);
        let triangles = BindGroupBuilder::new(&layouts.triangles).buffer(&batch.positions.buffer);
        let triangles = match &batch.attributes {
            Some(attributes) => triangles.buffer(&attributes.buffer),
            None => triangles.buffer(&fallbacks.attributes),
        };
        let triangles = triangles
            .buffer(&batch.indices.buffer)
            .buffer(&draws)
            .build(device, "voxelize::triangles");

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
        kernels.split.run_linear(recorder, &[grid, &triangles, &split], count);
        kernels.scan.run(recorder, &item_starts, prepared.triangle_count + 1);

        let runs: Vec<Run> = prepared
            .groups
            .iter()
            .map(|group| Run { first: group.triangles.start, end: group.triangles.end })
            .collect();
        let arguments = kernels.indirect.arguments(recorder, &item_starts, &runs, &counts);
        let dispatch = |group: &DrawGroup| GroupDispatch {
            run: run_group(device, layouts, fallbacks, group, &materials[group.material as usize]),
            triangles: group.triangles.clone(),
            detail: group.detail,
        };
        let groups = prepared.groups.iter().map(dispatch).collect();
        Ok(Self { triangles, item_starts, counts, groups, arguments })
    }

    /// Dispatches a walk over the items of all groups, each with the kernel that is chosen for it;
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
                &self.arguments,
                index as u64 * Indirect::STRIDE,
            );
        }
    }
}

impl SplitBatch {
    /// The runs of triangles that share textures, for a walk of the caller's own; `own` is bind group 2.
    pub fn runs<'a>(
        &'a self,
        globals: &'a BindGroup,
        own: &'a BindGroup,
    ) -> impl Iterator<Item = WalkRun<'a>> {
        self.groups.iter().map(move |group| WalkRun {
            detail: group.detail,
            triangles: group.triangles.clone(),
            groups: [globals, &self.triangles, own, &group.run],
        })
    }
}

fn run_group(
    device: &wgpu::Device,
    layouts: &Layouts,
    fallbacks: &Fallbacks,
    group: &DrawGroup,
    material: &SurfaceMaterial,
) -> BindGroup {
    let run = ItemRun {
        first_triangle: group.triangles.start,
        end_triangle: group.triangles.end,
        first_draw: group.draws.start,
        end_draw: group.draws.end,
    };
    let run = uniform_buffer(device, "run of items", &run);
    let textures =
        [&material.reflectance_texture, &material.emission_texture, &material.transmission_texture];
    textures
        .into_iter()
        .fold(BindGroupBuilder::new(&layouts.run).buffer(&run), |builder, texture| match texture {
            Some(texture) => builder.view(&texture.view).sampler(&texture.sampler),
            None => builder.view(&fallbacks.white).sampler(&fallbacks.sampler),
        })
        .build(device, "voxelize::run")
}
