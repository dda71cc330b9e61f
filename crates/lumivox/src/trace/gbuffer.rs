//! The G-buffer, rendered by the caller, from which the cones start.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec2, Vec3};

use crate::gpu::{BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines, upload};
use crate::mounted::{Mounted, Resource};

/// The camera of a G-buffer, for one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CameraView {
    /// From the world to clip space (y up, z reversed: 1 near, 0 far), including sub-pixel jitter.
    /// A caller's own G-buffer module may use another depth.
    pub clip_from_world: Mat4,
    /// `clip_from_world` of the previous frame, but with the jitter of this frame, for motion.
    /// Default: `clip_from_world`.
    pub previous_clip_from_world: Mat4,
    /// Position of the camera, m.
    pub position: Vec3,
    /// The picture's width and height in pixels.
    pub size: UVec2,
    /// Number of frames since the picture last changed. It advances the jitter of the cones.
    /// Without [`TraceSettings::temporal`](crate::TraceSettings::temporal), pixels share less and
    /// less light with their neighbours: all in frame 0, half in frame 2, a tenth in frame 18.
    /// Default: 0.
    pub frame: u32,
    /// Sub-pixel shift of the picture by the matrices, so that frames sample different positions:
    /// in pixels, x to the right, y down. It is in both matrices, since it is not motion. Default:
    /// 0.
    pub jitter: Vec2,
}

impl CameraView {
    /// The first frame of a static camera.
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

/// In [`GBufferViews::motion`], the x of a surface that is static in the world: only the camera
/// moves it in the picture. A pass that draws moving objects clears its target to this.
pub const AS_THE_CAMERA: f32 = 1024.0;

/// Views of the G-buffer's textures, all with the picture's size.
#[derive(Clone, Copy, Debug)]
pub struct GBufferViews<'a> {
    /// `Depth32Float`, reversed z; 0 where there is no surface.
    pub depth: &'a wgpu::TextureView,
    /// Octahedral shading normal in xy and geometric normal in zw, both towards the camera
    /// (`Rgba16Float`).
    pub normals: &'a wgpu::TextureView,
    /// Diffuse albedo, and in a one minus the strength of a clear coat: 1 without a coat
    /// (`Rgba8UnormSrgb` or any other float format).
    pub diffuse: &'a wgpu::TextureView,
    /// Specular reflectance at normal incidence, and perceptual roughness in a.
    pub specular: &'a wgpu::TextureView,
    /// Emitted radiance, and in a the coat's perceptual roughness (`Rgba16Float`).
    pub emission: &'a wgpu::TextureView,
    /// In xy the position of a pixel's surface in the picture minus its position in the previous
    /// frame, as a share of the picture, x to the right, y down (`Rg16Float`); [`AS_THE_CAMERA`]
    /// for static surfaces. `None` if only the camera moves
    /// ([`CameraView::previous_clip_from_world`]). It is read only if light of earlier frames is
    /// reused ([`TraceSettings::temporal`](crate::TraceSettings::temporal)).
    pub motion: Option<&'a wgpu::TextureView>,
}

/// A G-buffer bound for the shaders (group 3).
#[derive(Debug)]
pub struct GBuffer {
    /// The bind group, with the layout [`crate::Gi::gbuffer_layout`].
    pub group: BindGroup,
    /// The picture's width and height in pixels.
    pub size: UVec2,
    view: Buffer,
    has_motion: bool,
}

/// The layout of group 3: the camera, followed by the bindings of the caller's module or Lumivox's
/// own.
pub fn gbuffer_layout(device: &Pipelines, own: Option<&Mounted>) -> wgpu::BindGroupLayout {
    // The caller's fragment shaders may read it as well.
    let stages = wgpu::ShaderStages::COMPUTE | wgpu::ShaderStages::FRAGMENT;
    let camera = LayoutBuilder::new(stages).storage();
    let layout = match own {
        Some(own) => own.bindings.iter().fold(camera, |layout, ty| layout.binding(*ty)),
        None => (0..5).fold(camera.depth_2d(), |layout, _| layout.texture_2d_unfilterable()),
    };
    layout.build(device, "G-buffer")
}

impl GBuffer {
    /// Binds a G-buffer; the caller keeps the ownership of the views.
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
            // The placeholder is not read.
            .view(views.motion.unwrap_or(views.normals))
            .build(device, "G-buffer");
        Self { group, size: view.size, view: uniform, has_motion }
    }

    /// Binds the resources of the caller's own module.
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

    /// Sets the camera of the next frame. The write takes effect at the next submission, for
    /// everything submitted then: bind one G-buffer per camera, and submit each frame separately.
    pub fn set_camera(&self, queue: &wgpu::Queue, view: CameraView) {
        let uniform = view.to_gpu(self.has_motion);
        queue.write_buffer(&self.view, 0, bytemuck::bytes_of(&uniform));
    }
}
