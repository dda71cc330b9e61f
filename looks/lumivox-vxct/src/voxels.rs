//! The voxels: one texture with a colour and an opacity per cell, and its mips.

use lumivox::gpu::pipelines::{DrawPipeline, DrawPlan};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, ShaderError,
    ShaderLibrary, Texture, TextureView, storage_buffer,
};
use lumivox::internal::Kept;

use super::LAST_LEVEL;
use super::passes::Layouts;
use lumivox_render::look::LookParts;
use lumivox_render::{Gpu, GpuScene, RenderError};

const FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
/// Format of the render target that WebGPU requires: one byte per pixel, never written.
const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::R8Unorm;

/// The voxels, and the pipelines that make them.
#[derive(Debug)]
pub(super) struct Voxels {
    own: DrawPipeline,
    paint: DrawPipeline,
    clear: Kernel,
    clear_group: BindGroup,
    mip: Kernel,
    mip_groups: Vec<BindGroup>,
    owners: Buffer,
    group: BindGroup,
    pub(super) resolution: u32,
    /// All levels.
    pub(super) view: TextureView,
    levels: u32,
}

impl Voxels {
    /// Creates empty voxels.
    ///
    /// # Errors
    /// [`RenderError::Limit`] if the device does not allow such textures or buffers; another error
    /// if a shader does not link.
    pub(super) fn new(
        parts: &LookParts<'_>,
        shaders: &ShaderLibrary,
        layouts: &Layouts,
    ) -> Result<Self, RenderError> {
        let LookParts { gpu, scene, resolution, .. } = *parts;
        check(gpu, resolution)?;
        let device = &gpu.pipelines;
        let levels = 1 + LAST_LEVEL.min(resolution.ilog2());
        let texture = Texture::new(
            device,
            &wgpu::TextureDescriptor {
                label: Some("VXCT's voxels"),
                size: wgpu::Extent3d {
                    width: resolution,
                    height: resolution,
                    depth_or_array_layers: resolution,
                },
                mip_level_count: levels,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D3,
                format: FORMAT,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::STORAGE_BINDING,
                view_formats: &[],
            },
        );
        let level_view = |level| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: level,
                mip_level_count: Some(1),
                ..Default::default()
            })
        };
        let owners = storage_buffer(device, "last triangles", 4 * u64::from(resolution).pow(3));
        let layout = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT)
            .storage_mut()
            .storage_texture(wgpu::TextureViewDimension::D3, FORMAT)
            .build(device, "VXCT's voxels");
        let group = BindGroupBuilder::new(&layout)
            .buffer(&owners)
            .view(&level_view(0))
            .build(device, "VXCT's voxels");
        let mip_layout = LayoutBuilder::compute()
            .texture_3d()
            .storage_texture(wgpu::TextureViewDimension::D3, FORMAT)
            .build(device, "VXCT's mips");
        let from_to = |from, to| {
            BindGroupBuilder::new(&mip_layout)
                .view(&level_view(from))
                .view(&level_view(to))
                .build(device, "VXCT's mips")
        };
        let groups = [&layouts.look, &scene.material_layout, &layouts.batch, &layout];
        Ok(Self {
            own: pipeline(device, shaders, groups, "own")?,
            paint: pipeline(device, shaders, groups, "paint")?,
            clear: Kernel::new(device, shaders, "vxct::mip", "clear", &[&mip_layout])?,
            clear_group: from_to(1, 0),
            mip: Kernel::new(device, shaders, "vxct::mip", "main", &[&mip_layout])?,
            mip_groups: (1..levels).map(|level| from_to(level - 1, level)).collect(),
            owners,
            group,
            resolution,
            view: texture.view(),
            levels,
        })
    }

    /// Makes the voxels again.
    pub(super) fn record(
        &self,
        recorder: &mut Recorder,
        scene: &GpuScene,
        look: &BindGroup,
        batches: &[BindGroup],
    ) {
        recorder.clear(&self.owners);
        let edge = self.resolution;
        self.clear.run(recorder, &[&self.clear_group], [edge; 3]);
        let picture = Texture::new(
            recorder.device(),
            &wgpu::TextureDescriptor {
                label: Some("columns of voxels"),
                size: wgpu::Extent3d { width: edge, height: edge, depth_or_array_layers: 1 },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: PICTURE_FORMAT,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            },
        );
        let view = picture.view();
        for (label, pipeline) in [("vxct::own", &self.own), ("vxct::paint", &self.paint)] {
            let attachment = wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::BLACK),
                    store: wgpu::StoreOp::Discard,
                },
            };
            recorder.render(label, &[Some(attachment)], None, |pass| {
                pass.set_pipeline(pipeline);
                pass.bind(0, look);
                pass.bind(3, &self.group);
                for draw in &scene.draws {
                    pass.bind(1, &scene.materials[draw.material].group);
                    pass.bind(2, &batches[draw.batch]);
                    pass.draw(0..draw.indices.len() as u32, draw.record..draw.record + 1);
                }
            });
        }
        recorder.keep(Kept::Texture(picture));
        for (level, group) in (1..).zip(&self.mip_groups) {
            let edge = (self.resolution >> level).max(1);
            self.mip.run(recorder, &[group], [edge; 3]);
        }
    }

    /// The existing level that is nearest to `level`.
    pub(super) fn level(&self, level: u32) -> u32 {
        level.min(self.levels - 1)
    }

    /// Size in bytes.
    pub(super) fn bytes(&self) -> u64 {
        let cells: u64 =
            (0..self.levels).map(|level| u64::from((self.resolution >> level).max(1)).pow(3)).sum();
        4 * cells + self.owners.size()
    }
}

fn check(gpu: &Gpu, resolution: u32) -> Result<(), RenderError> {
    let limits = gpu.device.limits();
    let owners = 4 * u64::from(resolution).pow(3);
    let edge = u64::from(limits.max_texture_dimension_3d);
    let checks = [
        (
            owners,
            "bytes",
            "max_storage_buffer_binding_size",
            limits.max_storage_buffer_binding_size,
        ),
        (u64::from(resolution), "texels", "max_texture_dimension_3d", edge),
    ];
    for (needed, unit, limit, available) in checks {
        if needed > available {
            return Err(RenderError::Limit {
                what: format!("the voxels of VXCT's look, {resolution} along each axis"),
                needed,
                unit,
                limit,
                available,
                remedy: "take 64, 128 or 256 voxels, as VXCT does (--resolution 256)".to_owned(),
            });
        }
    }
    Ok(())
}

fn pipeline(
    device: &Pipelines,
    shaders: &ShaderLibrary,
    groups: [&wgpu::BindGroupLayout; 4],
    entry: &str,
) -> Result<DrawPipeline, ShaderError> {
    let shader = device.shader(shaders, "vxct::voxelize")?;
    let target = wgpu::ColorTargetState {
        format: PICTURE_FORMAT,
        blend: None,
        write_mask: wgpu::ColorWrites::empty(),
    };
    Ok(device.draw(DrawPlan {
        fragment: Some(shader.entry(entry)?),
        targets: vec![Some(target)],
        groups: groups.map(Clone::clone).to_vec(),
        ..DrawPlan::new(&shader, "main")?
    }))
}
