//! A G-buffer of a room, drawn on the GPU as by an engine.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec3};

use crate::gpu::uniform_buffer;
use crate::trace::CameraView;

/// The size of the room of [`crate::testing::busy_room`].
const ROOM: Vec3 = Vec3::new(1.0, 0.7, 0.9);

#[repr(C)]
#[derive(Clone, Copy, Pod, Zeroable)]
struct Camera {
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    position: Vec3,
    width: f32,
    room: Vec3,
    height: f32,
}

/// A camera in the room.
pub(crate) fn view(size: UVec2) -> CameraView {
    let position = Vec3::new(0.15, 0.4, 0.1);
    let aspect = size.x as f32 / size.y as f32;
    let clip_from_view =
        glam::camera::rh::proj::directx::perspective_infinite_reverse(1.3, aspect, 0.05);
    let view_from_world =
        glam::camera::rh::view::look_at_mat4(position, Vec3::new(0.7, 0.3, 0.8), Vec3::Y);
    CameraView { frame: Some(1), ..CameraView::new(clip_from_view * view_from_world, position) }
}

/// Draws the room with a fragment shader of `room.wgsl`, into a depth texture and textures of the
/// given formats.
pub(crate) fn draw(
    (device, queue): (&wgpu::Device, &wgpu::Queue),
    (view, size): (CameraView, UVec2),
    entry: &str,
    formats: &[wgpu::TextureFormat],
) -> (wgpu::TextureView, Vec<wgpu::TextureView>) {
    let texture = |format| {
        let size = wgpu::Extent3d { width: size.x, height: size.y, ..Default::default() };
        let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING;
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("test G-buffer"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage,
            view_formats: &[],
        });
        texture.create_view(&wgpu::TextureViewDescriptor::default())
    };
    let depth_format = wgpu::TextureFormat::Depth32Float;
    let depth = texture(depth_format);
    let colors: Vec<wgpu::TextureView> = formats.iter().map(|format| texture(*format)).collect();
    let shader = device.create_shader_module(wgpu::include_wgsl!("room.wgsl"));
    let targets: Vec<_> = formats.iter().map(|format| Some((*format).into())).collect();
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("test G-buffer"),
        layout: None,
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: depth_format,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: wgpu::StencilState::default(),
            bias: wgpu::DepthBiasState::default(),
        }),
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some(entry),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &targets,
        }),
        multiview_mask: None,
        cache: None,
    });
    let camera = Camera {
        clip_from_world: view.clip_from_world,
        world_from_clip: view.clip_from_world.inverse(),
        position: view.position,
        width: size.x as f32,
        room: ROOM,
        height: size.y as f32,
    };
    let camera = uniform_buffer(device, "test camera", &camera);
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
        label: None,
        layout: &pipeline.get_bind_group_layout(0),
        entries: &[wgpu::BindGroupEntry { binding: 0, resource: camera.as_entire_binding() }],
    });
    let attachment = |view| {
        let ops = wgpu::Operations { load: wgpu::LoadOp::default(), store: wgpu::StoreOp::Store };
        Some(wgpu::RenderPassColorAttachment { view, depth_slice: None, resolve_target: None, ops })
    };
    let attachments: Vec<_> = colors.iter().map(attachment).collect();
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: None,
            color_attachments: &attachments,
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &depth,
                depth_ops: Some(wgpu::Operations {
                    load: wgpu::LoadOp::Clear(0.0),
                    store: wgpu::StoreOp::Store,
                }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    queue.submit([encoder.finish()]);
    (depth, colors)
}

/// Formats for Lumivox's own G-buffer, all of half floats.
pub(super) const FORMATS: [wgpu::TextureFormat; 4] = [
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba16Float,
    wgpu::TextureFormat::Rgba16Float,
];
