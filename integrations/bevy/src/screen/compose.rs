//! Adds the light of the cones to Bevy's picture.

use bevy::core_pipeline::core_3d::CORE_3D_DEPTH_FORMAT;
use lumivox::gpu::pipelines::{DrawPipeline, DrawPlan};
use lumivox::gpu::{
    BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, RenderPass, uniform_buffer,
};
use lumivox::{Gi, GiError, GiView, wgpu};

/// Format of Bevy's HDR pictures.
pub(crate) const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The compose pipeline of one `Gi`.
pub(crate) struct Compose {
    pipeline: DrawPipeline,
    layout: wgpu::BindGroupLayout,
    nothing: BindGroup,
}

/// The bindings of one view.
pub(crate) struct ComposeView {
    group: BindGroup,
    settings: Buffer,
    factor: f32,
}

/// `ComposeSettings` of `compose.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct ComposeSettings {
    picture_from_radiance: f32,
    padding: [f32; 3],
}

impl ComposeSettings {
    fn new(picture_from_radiance: f32) -> Self {
        Self { picture_from_radiance, padding: [0.0; 3] }
    }
}

impl Compose {
    pub(crate) fn new(gi: &Gi) -> Result<Self, GiError> {
        debug_assert_eq!(CORE_3D_DEPTH_FORMAT, wgpu::TextureFormat::Depth32Float);
        let pipelines = gi.pipelines();
        let mut library = gi.shaders().clone();
        library.add("bevy::compose", include_str!("compose.wgsl"));
        let shader = pipelines.shader(&library, "bevy::compose")?;
        let empty = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT).build(pipelines, "nothing");
        let layout = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT)
            .uniform()
            .texture_2d_unfilterable()
            .texture_2d_unfilterable()
            .build(pipelines, "compose");
        let one = wgpu::BlendComponent {
            src_factor: wgpu::BlendFactor::One,
            dst_factor: wgpu::BlendFactor::One,
            operation: wgpu::BlendOperation::Add,
        };
        let target = wgpu::ColorTargetState {
            format: PICTURE_FORMAT,
            blend: Some(wgpu::BlendState { color: one, alpha: one }),
            write_mask: wgpu::ColorWrites::COLOR,
        };
        let plan = DrawPlan {
            fragment: Some(shader.entry("add")?),
            targets: vec![Some(target)],
            groups: vec![empty.clone(), layout.clone(), empty.clone(), gi.gbuffer_layout().clone()],
            ..DrawPlan::new(&shader, "cover")?
        };
        let nothing = BindGroupBuilder::new(&empty).build(pipelines.device(), "nothing");
        Ok(Self { pipeline: pipelines.draw(plan), layout, nothing })
    }

    pub(crate) fn view(&self, gi: &Gi, traced: &GiView) -> ComposeView {
        let device = gi.pipelines().device();
        let settings = uniform_buffer(device, "compose", &ComposeSettings::new(0.0));
        let group = BindGroupBuilder::new(&self.layout)
            .buffer(&settings)
            .view(traced.irradiance())
            .view(traced.specular())
            .build(device, "compose");
        ComposeView { group, settings, factor: 0.0 }
    }

    /// Draws into a picture, within its viewport.
    pub(crate) fn draw(&self, pass: &mut RenderPass<'_>, view: &ComposeView, traced: &GiView) {
        pass.set_pipeline(&self.pipeline);
        pass.bind(0, &self.nothing);
        pass.bind(1, &view.group);
        pass.bind(2, &self.nothing);
        pass.bind(3, traced.group());
        pass.draw(0..3, 0..1);
    }
}

impl ComposeView {
    /// Sets the factor from radiance to the picture's values.
    pub(crate) fn set(&mut self, queue: &wgpu::Queue, picture_from_radiance: f32) {
        if self.factor != picture_from_radiance {
            self.factor = picture_from_radiance;
            let settings = ComposeSettings::new(picture_from_radiance);
            queue.write_buffer(&self.settings, 0, bytemuck::bytes_of(&settings));
        }
    }
}
