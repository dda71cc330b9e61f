//! The G-buffer that the caller renders and the cones start from.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec2, Vec3};

use crate::gpu::{BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, upload};
use crate::mounted::{Mounted, Resource};

/// The camera of a G-buffer, for one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CameraView {
    /// From the world to clip space (y up, z reversed: 1 near, 0 far), sub-pixel jitter included. A G-buffer module
    /// of the caller's own may have another depth.
    pub clip_from_world: Mat4,
    /// As `clip_from_world` was in the frame before, but with the jitter of this frame, for motion; equal to it by default.
    pub previous_clip_from_world: Mat4,
    /// Where the camera stands, m.
    pub position: Vec3,
    /// The picture's width and height in pixels.
    pub size: UVec2,
    /// Number of the frame since the picture last changed; it moves the jitter of the cones, and without
    /// [`TraceSettings::temporal`](crate::TraceSettings::temporal) pixels share less and less light with their neighbours: all in
    /// frame 0, half in frame 2, a tenth in frame 18. Default: 0.
    pub frame: u32,
    /// How far the matrices move the picture within a pixel, so that frames sample different places: in pixels, x to the right, y
    /// down. It is in both matrices, since it is no motion. Default: 0.
    pub jitter: Vec2,
}

impl CameraView {
    /// The first frame of a camera that stands still.
    pub fn new(clip_from_world: Mat4, position: Vec3, size: UVec2) -> Self {
        let previous_clip_from_world = clip_from_world;
        let jitter = Vec2::ZERO;
        Self { clip_from_world, previous_clip_from_world, position, size, frame: 0, jitter }
    }

    fn to_gpu(self, has_motion: bool) -> CameraViewUniform {
        CameraViewUniform {
            clip_from_world: self.clip_from_world,
            world_from_clip: self.clip_from_world.inverse(),
            previous_clip_from_world: self.previous_clip_from_world,
            previous_world_from_clip: self.previous_clip_from_world.inverse(),
            position_in_world: self.position.to_array(),
            frame: self.frame,
            size: self.size.to_array(),
            has_motion: u32::from(has_motion),
            padding_0: 0,
            jitter: self.jitter.to_array(),
            padding_1: [0; 2],
        }
    }
}

/// `CameraView` of `view.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub(crate) struct CameraViewUniform {
    clip_from_world: Mat4,
    world_from_clip: Mat4,
    previous_clip_from_world: Mat4,
    previous_world_from_clip: Mat4,
    position_in_world: [f32; 3],
    frame: u32,
    size: [u32; 2],
    has_motion: u32,
    padding_0: u32,
    jitter: [f32; 2],
    padding_1: [u32; 2],
}

/// In [`GBufferViews::motion`], the x of a surface that stands still in the world: it moves over the picture only as the camera
/// does. A pass that draws what moves clears its target to this.
pub const AS_THE_CAMERA: f32 = 1024.0;

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
    /// In xy where a pixel's surface is in the picture minus where it was in the frame before, in shares of the
    /// picture, x to the right, y down (`Rg16Float`); [`AS_THE_CAMERA`] where nothing moves by itself. `None`: nothing moves but
    /// the camera ([`CameraView::previous_clip_from_world`]). It is read where light of earlier frames is carried along
    /// ([`TraceSettings::temporal`](crate::TraceSettings::temporal)).
    pub motion: Option<&'a wgpu::TextureView>,
}

/// A G-buffer bound for the shaders (group 3).
#[derive(Debug)]
pub struct GBuffer {
    /// The bind group, of the layout [`crate::Gi::gbuffer_layout`].
    pub group: BindGroup,
    /// The picture's width and height in pixels.
    pub size: UVec2,
    view: Buffer,
    has_motion: bool,
}

/// The layout of group 3: the camera, and what the caller's module binds or Lumivox's own.
pub fn gbuffer_layout(device: &Pipelines, own: Option<&Mounted>) -> wgpu::BindGroupLayout {
    // Fragment shaders of the caller's may read it as well.
    let stages = wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT;
    let camera = LayoutBuilder::new(stages).storage();
    let layout = match own {
        Some(own) => own.bindings.iter().fold(camera, |layout, ty| layout.binding(*ty)),
        None => (0..5).fold(camera.depth_2d(), |layout, _| layout.texture_2d_unfilterable()),
    };
    layout.build(device, "G-buffer")
}

impl GBuffer {
    /// Binds a G-buffer; the views stay the caller's.
    pub(crate) fn new(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        views: GBufferViews<'_>,
        view: CameraView,
    ) -> Self {
        let has_motion = views.motion.is_some();
        let uniform = upload(device, "view", &[view.to_gpu(has_motion)]);
        let group = BindGroupBuilder::new(layout)
            .buffer(&uniform)
            .view(views.depth)
            .view(views.normals)
            .view(views.diffuse)
            .view(views.specular)
            .view(views.emission)
            // Nothing reads the one that stands in.
            .view(views.motion.unwrap_or(views.normals))
            .build(device, "G-buffer");
        Self { group, size: view.size, view: uniform, has_motion }
    }

    /// Binds what the caller's own module reads.
    pub(crate) fn own(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        resources: &[Resource],
        view: CameraView,
    ) -> Self {
        let uniform = upload(device, "view", &[view.to_gpu(false)]);
        let group = resources
            .iter()
            .fold(BindGroupBuilder::new(layout).buffer(&uniform), |group, resource| {
                group.resource(resource.binding())
            })
            .build(device, "G-buffer");
        Self { group, size: view.size, view: uniform, has_motion: false }
    }

    /// Sets the camera of the next frame. The write takes effect at the next submission, for all that is submitted
    /// then: bind a G-buffer for each camera, and submit each frame by itself.
    pub fn set_camera(&self, queue: &wgpu::Queue, view: CameraView) {
        let uniform = view.to_gpu(self.has_motion);
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
    }
}
