//! The G-buffer that the caller renders and the cones start from.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec3};

use crate::gpu::{BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, upload};

/// The camera of a G-buffer, for one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraView {
    /// From the world to clip space (y up, z reversed: 1 near, 0 far), sub-pixel jitter included.
    pub clip_from_world: Mat4,
    /// Where the camera stands, m.
    pub position: Vec3,
    /// The picture's width and height in pixels.
    pub size: UVec2,
    /// Number of the frame since the picture last changed; it moves the jitter of the cones.
    pub frame: u32,
}

/// `CameraView` of `gbuffer.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CameraViewUniform {
    pub(crate) clip_from_world: Mat4,
    pub(crate) world_from_clip: Mat4,
    pub(crate) position_in_world: [f32; 3],
    pub(crate) frame: u32,
    pub(crate) size: [u32; 2],
    pub(crate) padding: [u32; 2],
}

/// Views of the G-buffer's textures, all of the picture's size.
#[derive(Clone, Copy, Debug)]
pub struct GBufferViews<'a> {
    /// `Depth32Float`, reversed z; 0 where there is nothing.
    pub depth: &'a wgpu::TextureView,
    /// Octahedral shading normal in xy and geometric normal in zw, both towards the camera (`Rgba16Float`).
    pub normals: &'a wgpu::TextureView,
    /// Diffuse albedo, and in a one minus the strength of a clear coat on top: 1 where there is none
    /// (`Rgba8UnormSrgb` or any other float format).
    pub diffuse: &'a wgpu::TextureView,
    /// Specular reflectance at normal incidence, and perceptual roughness in a.
    pub specular: &'a wgpu::TextureView,
    /// Emitted radiance, and in a the coat's perceptual roughness (`Rgba16Float`).
    pub emission: &'a wgpu::TextureView,
}

/// A G-buffer bound for the shaders (group 3).
#[derive(Debug)]
pub struct GBuffer {
    /// The bind group, of the layout [`crate::Gi::gbuffer_layout`].
    pub group: BindGroup,
    /// The picture's width and height in pixels.
    pub size: UVec2,
    view: Buffer,
}

/// The layout of group 3: the camera and the G-buffer.
pub fn gbuffer_layout(device: &Pipelines) -> wgpu::BindGroupLayout {
    LayoutBuilder::compute()
        .storage()
        .depth_2d()
        .texture_2d_unfilterable()
        .texture_2d_unfilterable()
        .texture_2d_unfilterable()
        .texture_2d_unfilterable()
        .build(device, "G-buffer")
}

impl CameraView {
    pub(crate) fn to_gpu(self) -> CameraViewUniform {
        CameraViewUniform {
            clip_from_world: self.clip_from_world,
            world_from_clip: self.clip_from_world.inverse(),
            position_in_world: self.position.to_array(),
            frame: self.frame,
            size: self.size.to_array(),
            padding: [0; 2],
        }
    }
}

impl GBuffer {
    /// Binds a G-buffer; the views stay the caller's.
    pub fn new(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        views: GBufferViews<'_>,
        view: CameraView,
    ) -> Self {
        let uniform = upload(device, "view", &[view.to_gpu()]);
        let group = BindGroupBuilder::new(layout)
            .buffer(&uniform)
            .view(views.depth)
            .view(views.normals)
            .view(views.diffuse)
            .view(views.specular)
            .view(views.emission)
            .build(device, "G-buffer");
        Self { group, size: view.size, view: uniform }
    }

    /// Sets the camera of the next frame. The write takes effect at the next submission: with several frames
    /// in one recorder, call `Recorder::flush` between them.
    pub fn set_camera(&self, queue: &wgpu::Queue, view: CameraView) {
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&view.to_gpu()));
    }
}
