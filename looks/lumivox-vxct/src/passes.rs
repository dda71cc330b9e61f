//! The passes of a frame: surfaces with the background behind them, or the voxels as cubes.

use std::collections::HashMap;
use std::collections::hash_map::Entry;

use bytemuck::Zeroable;
use glam::UVec2;
use lumivox::gpu::pipelines::{DrawPipeline, DrawPlan, Shader};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, Kernel, LayoutBuilder, Pipelines, Recorder, Texture,
    TextureView, uniform_buffer,
};
use lumivox_render::look::{DEPTH_FORMAT, LookFrame, LookParts, NORMALS_FORMAT, PICTURE_FORMAT};
use lumivox_render::{GpuScene, RenderError};

use super::VxctUniform;
use super::records::{Records, Sides};
use super::voxels::Voxels;

/// Format of the drawn surfaces without background: display values, in half floats to 1/2000.
const DRAWN_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The layouts that the passes share.
#[derive(Debug)]
pub(super) struct Layouts {
    /// Settings, draws, lights.
    pub(super) look: wgpu::BindGroupLayout,
    /// The buffers of a batch of triangles.
    pub(super) batch: wgpu::BindGroupLayout,
}

/// The passes, linked against a volume's library, for voxels of one resolution.
#[derive(Debug)]
pub(super) struct Passes {
    pub(super) layouts: Layouts,
    pub(super) settings: Buffer,
    pub(super) voxels: Voxels,
    shader: Shader,
    pipelines: HashMap<Sides, DrawPipeline>,
    cones_layout: wgpu::BindGroupLayout,
    cones: BindGroup,
    finish: Kernel,
    finish_layout: wgpu::BindGroupLayout,
    cubes: Kernel,
    cubes_layout: wgpu::BindGroupLayout,
    /// The drawn surfaces, of the last picture's size.
    drawn: Option<TextureView>,
}

impl Passes {
    pub(super) fn new(parts: &LookParts<'_>) -> Result<Self, RenderError> {
        let LookParts { gpu, gi, .. } = *parts;
        let shaders = &super::library(parts.shaders);
        let device = &gpu.pipelines;
        let stages = wgpu::ShaderStages::VERTEX_FRAGMENT | wgpu::ShaderStages::COMPUTE;
        let layouts = Layouts {
            look: LayoutBuilder::new(stages)
                .uniform()
                .storage()
                .storage()
                .storage()
                .build(device, "the look of VXCT"),
            batch: LayoutBuilder::new(wgpu::ShaderStages::VERTEX)
                .storage()
                .storage()
                .storage()
                .storage()
                .build(device, "triangles"),
        };
        let voxels = Voxels::new(parts, shaders, &layouts)?;
        let cones_layout = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT)
            .texture_3d()
            .sampler()
            .build(device, "VXCT's cones");
        let sampler = gpu.device.create_sampler(&wgpu::SamplerDescriptor {
            label: Some("VXCT's voxels"),
            mag_filter: wgpu::FilterMode::Linear,
            min_filter: wgpu::FilterMode::Linear,
            mipmap_filter: wgpu::MipmapFilterMode::Linear,
            ..Default::default()
        });
        let cones = BindGroupBuilder::new(&cones_layout)
            .view(&voxels.view)
            .sampler(&sampler)
            .build(device, "VXCT's cones");
        let picture = |texture: LayoutBuilder, label: &str| {
            texture
                .storage_texture(wgpu::TextureViewDimension::D2, PICTURE_FORMAT)
                .build(device, label)
        };
        let finish_layout = picture(LayoutBuilder::compute().texture_2d_unfilterable(), "finish");
        let cubes_layout = picture(LayoutBuilder::compute().texture_3d(), "VXCT's cubes");
        let kernel = |module: &str, own: &wgpu::BindGroupLayout| {
            let groups = [&layouts.look, own, gi.lights_layout(), gi.gbuffer_layout()];
            Kernel::new(device, shaders, module, "main", &groups)
        };
        Ok(Self {
            settings: uniform_buffer(device, "the look of VXCT", &VxctUniform::zeroed()),
            voxels,
            shader: device.shader(shaders, "vxct::shade")?,
            pipelines: HashMap::new(),
            cones,
            cones_layout,
            finish: kernel("vxct::finish", &finish_layout)?,
            finish_layout,
            cubes: kernel("vxct::cubes", &cubes_layout)?,
            cubes_layout,
            drawn: None,
            layouts,
        })
    }

    /// Creates the pipeline for `sides` if it does not exist.
    pub(super) fn prepare(
        &mut self,
        pipelines: &Pipelines,
        scene: &GpuScene,
        sides: Sides,
    ) -> Result<(), RenderError> {
        let Entry::Vacant(slot) = self.pipelines.entry(sides) else { return Ok(()) };
        let over = |src_factor| wgpu::BlendComponent {
            src_factor,
            dst_factor: wgpu::BlendFactor::OneMinusSrcAlpha,
            operation: wgpu::BlendOperation::Add,
        };
        let target = wgpu::ColorTargetState {
            format: DRAWN_FORMAT,
            blend: Some(wgpu::BlendState {
                color: over(wgpu::BlendFactor::SrcAlpha),
                alpha: over(wgpu::BlendFactor::One),
            }),
            write_mask: wgpu::ColorWrites::ALL,
        };
        let (look, batch) = (&self.layouts.look, &self.layouts.batch);
        let groups = [look, &scene.material_layout, batch, &self.cones_layout];
        slot.insert(pipelines.draw(DrawPlan {
            fragment: Some(self.shader.entry("fragment")?),
            targets: vec![Some(target), Some(NORMALS_FORMAT.into())],
            groups: groups.map(Clone::clone).to_vec(),
            primitive: wgpu::PrimitiveState {
                front_face: wgpu::FrontFace::Ccw,
                cull_mode: match sides {
                    Sides::Front => Some(wgpu::Face::Back),
                    Sides::Back => Some(wgpu::Face::Front),
                    Sides::Both => None,
                },
                ..Default::default()
            },
            depth_stencil: Some(wgpu::DepthStencilState {
                format: DEPTH_FORMAT,
                depth_write_enabled: Some(true),
                depth_compare: Some(wgpu::CompareFunction::Greater),
                stencil: wgpu::StencilState::default(),
                bias: wgpu::DepthBiasState::default(),
            }),
            ..DrawPlan::new(&self.shader, "main")?
        }));
        Ok(())
    }

    /// Draws surfaces in the scene's order: transparent ones show earlier ones.
    pub(super) fn draw(
        &mut self,
        recorder: &mut Recorder,
        frame: &LookFrame<'_>,
        records: &Records,
        (look, batches): (&BindGroup, &[BindGroup]),
    ) {
        let (scene, size) = (frame.scene, frame.camera.size());
        let fits = |view: &TextureView| {
            let texture = view.texture();
            (texture.width(), texture.height()) == (size.x, size.y)
        };
        if self.drawn.as_ref().is_some_and(|view| !fits(view)) {
            self.drawn = None;
        }
        let device = recorder.device().clone();
        let drawn = self.drawn.get_or_insert_with(|| drawn_texture(&device, size).view());
        // Overlays need depths and normals.
        let colors = [&*drawn, frame.normals].map(|view| {
            Some(wgpu::RenderPassColorAttachment {
                view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations {
                    load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                    store: wgpu::StoreOp::Store,
                },
            })
        });
        let depth = wgpu::RenderPassDepthStencilAttachment {
            view: frame.depth,
            depth_ops: Some(wgpu::Operations {
                load: wgpu::LoadOp::Clear(0.0),
                store: wgpu::StoreOp::Store,
            }),
            stencil_ops: None,
        };
        recorder.render("vxct::shade", &colors, Some(depth), |pass| {
            pass.bind(0, look);
            pass.bind(3, &self.cones);
            for (number, draw) in scene.draws.iter().enumerate() {
                let Some(pipeline) = self.pipelines.get(&records.sides(scene, number)) else {
                    continue;
                };
                pass.set_pipeline(pipeline);
                pass.bind(1, &scene.materials[draw.material].group);
                pass.bind(2, &batches[draw.batch]);
                pass.draw(0..draw.indices.len() as u32, draw.record..draw.record + 1);
            }
        });
        let own = BindGroupBuilder::new(&self.finish_layout)
            .view(drawn)
            .view(frame.picture)
            .build(&device, "finish");
        let groups = [look, &own, &frame.lights.group, frame.camera.group()];
        self.finish.run(recorder, &groups, [size.x, size.y, 1]);
    }

    pub(super) fn draw_cubes(
        &self,
        recorder: &mut Recorder,
        frame: &LookFrame<'_>,
        look: &BindGroup,
    ) {
        let own = BindGroupBuilder::new(&self.cubes_layout)
            .view(&self.voxels.view)
            .view(frame.picture)
            .build(recorder.device(), "VXCT's cubes");
        let groups = [look, &own, &frame.lights.group, frame.camera.group()];
        let size = frame.camera.size();
        self.cubes.run(recorder, &groups, [size.x, size.y, 1]);
    }
}

fn drawn_texture(device: &wgpu::Device, size: UVec2) -> Texture {
    Texture::new(
        device,
        &wgpu::TextureDescriptor {
            label: Some("drawn"),
            size: wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DRAWN_FORMAT,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        },
    )
}
