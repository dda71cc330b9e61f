//! A camera: its G-buffer, the textures that its cones are traced into, and its history.

use bytemuck::{Pod, Zeroable};
use glam::{Mat4, UVec2, Vec2, Vec3};

use super::gbuffer::GBuffer;
use super::targets::TraceTargets;
use crate::cones::{TraceResolution, TraceSettings};
use crate::gpu::{BindGroup, Buffer, TextureView, upload};

/// The camera of one frame.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct CameraView {
    /// Transform from the world to clip space (y up, z reversed: 1 near, 0 far), without jitter. A
    /// caller's own G-buffer module may use another depth.
    pub clip_from_world: Mat4,
    /// Position of the camera, m.
    pub position: Vec3,
    /// Number of frames since the picture last changed, for a caller that averages frames. It
    /// advances the jitter of the cones. Without
    /// [`TraceSettings::temporal`](crate::TraceSettings::temporal), pixels share less and less
    /// light with their neighbours: all in frame 0, half in frame 2, a tenth in frame 18. Default:
    /// the number of frames that the view has traced.
    pub frame: Option<u32>,
    /// Sub-pixel shift of the picture, so that frames sample different positions: in pixels, x to
    /// the right, y down. The G-buffer must be drawn with it ([`GiView::clip_from_world`]). It is
    /// not part of the motion. Default: 0.
    pub jitter: Vec2,
}

impl CameraView {
    /// A camera without jitter.
    pub fn new(clip_from_world: Mat4, position: Vec3) -> Self {
        Self { clip_from_world, position, frame: None, jitter: Vec2::ZERO }
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

/// A camera whose cones are traced: its G-buffer, the output textures, and the light and the matrix
/// of the last frame. [`Gi::view`](crate::Gi::view) creates it, [`Gi::trace`](crate::Gi::trace)
/// traces it.
#[derive(Debug)]
pub struct GiView {
    /// The settings of its cones. Changes of `resolution` and `temporal` have no effect: the view
    /// keeps those that it was created with.
    pub settings: TraceSettings,
    group: BindGroup,
    uniform: Buffer,
    has_motion: bool,
    targets: TraceTargets,
    camera: CameraView,
    /// `clip_from_world` of the last frame.
    previous: Option<Mat4>,
    /// Number of traced frames.
    traced: u32,
}

impl GiView {
    pub(crate) fn new(
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        gbuffer: GBuffer<'_>,
        size: UVec2,
        settings: &TraceSettings,
    ) -> Self {
        let uniform = upload(device, "view", &[CameraViewUniform::zeroed()]);
        Self {
            settings: *settings,
            group: gbuffer.bind(device, layout, &uniform),
            uniform,
            has_motion: gbuffer.has_motion(),
            targets: TraceTargets::new(device, size, settings),
            camera: CameraView::new(Mat4::IDENTITY, Vec3::ZERO),
            previous: None,
            traced: 0,
        }
    }

    pub(crate) fn bind(
        &mut self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        gbuffer: GBuffer<'_>,
    ) {
        self.group = gbuffer.bind(device, layout, &self.uniform);
        self.has_motion = gbuffer.has_motion();
    }

    /// Sets the camera of the next frame. The write takes effect at the next submission, for all of
    /// its commands: use one view per camera, and submit each frame separately.
    pub fn set_camera(&mut self, queue: &wgpu::Queue, camera: CameraView) {
        self.camera = camera;
        let clip_from_world = self.clip_from_world();
        let previous_clip_from_world = self.previous_clip_from_world();
        let uniform = CameraViewUniform {
            clip_from_world,
            world_from_clip: clip_from_world.inverse(),
            previous_clip_from_world,
            previous_world_from_clip: previous_clip_from_world.inverse(),
            position_in_world: camera.position.to_array(),
            frame: camera.frame.unwrap_or(self.traced),
            size: self.size().to_array(),
            has_motion: u32::from(self.has_motion),
            padding_0: 0,
            jitter: camera.jitter.to_array(),
            padding_1: [0; 2],
        };
        queue.write_buffer(&self.uniform, 0, bytemuck::bytes_of(&uniform));
    }

    /// The camera of the next frame.
    pub fn camera(&self) -> &CameraView {
        &self.camera
    }

    /// The matrix for drawing the G-buffer of the next frame: that of the camera, with its jitter.
    pub fn clip_from_world(&self) -> Mat4 {
        self.jittered(self.camera.clip_from_world)
    }

    /// The matrix of the last frame, with the jitter of the next one: for the motion of surfaces
    /// ([`GBufferViews::motion`](crate::GBufferViews::motion)). Before the first frame, and after
    /// [`Self::forget`], the matrix of the next frame.
    pub fn previous_clip_from_world(&self) -> Mat4 {
        self.jittered(self.previous.unwrap_or(self.camera.clip_from_world))
    }

    fn jittered(&self, clip_from_world: Mat4) -> Mat4 {
        shift_of(self.camera.jitter, self.size()) * clip_from_world
    }

    /// Records that the current camera was traced.
    pub(crate) fn set_traced(&mut self) {
        self.previous = Some(self.camera.clip_from_world);
        self.traced = self.traced.wrapping_add(1);
    }

    /// Group 3 of everything that reads the camera and the G-buffer, with the layout
    /// [`Gi::gbuffer_layout`](crate::Gi::gbuffer_layout).
    pub fn group(&self) -> &BindGroup {
        &self.group
    }

    /// Irradiance in rgb; in a the open share of the hemisphere, weighted by the cosine.
    pub fn irradiance(&self) -> &TextureView {
        &self.targets.irradiance
    }

    /// Radiance reflected by the glossy lobe towards the camera in rgb, including the BRDF; in a
    /// the number of samples of the pixel, including diffuse ones.
    pub fn specular(&self) -> &TextureView {
        &self.targets.specular
    }

    /// Records of each pixel's surface, if light of earlier frames is kept: `Rg32Uint`, decoded by
    /// `package::temporal::record::decode_record`. They contain the number of frames in the mean of
    /// the light, and whether the surface is newly seen; zeros for pixels without surface.
    pub fn records(&self) -> Option<&TextureView> {
        self.targets.records.as_ref()
    }

    /// The picture's width and height in pixels.
    pub fn size(&self) -> UVec2 {
        self.targets.size()
    }

    /// `true` if light of earlier frames is kept.
    pub fn is_temporal(&self) -> bool {
        self.targets.is_temporal()
    }

    /// The resolution of the traces.
    pub fn resolution(&self) -> TraceResolution {
        self.targets.resolution()
    }

    /// Discards the light of earlier frames: for a cut, or another scene.
    pub fn forget(&mut self) {
        (self.previous, self.traced) = (None, 0);
        self.targets.forget();
    }

    /// Call instead of [`Gi::trace`](crate::Gi::trace) for a frame without traced light: discards
    /// the light of earlier frames, but remembers the camera.
    pub fn skip(&mut self) {
        self.previous = Some(self.camera.clip_from_world);
        self.targets.forget();
    }

    /// Continues with the history of a view of another size: for pictures whose size depends on the
    /// frame rate. Both must belong to the same [`Gi`](crate::Gi). Does nothing unless both keep
    /// light of earlier frames.
    pub fn take_past(&mut self, former: &Self) {
        if self.is_temporal() && former.is_temporal() {
            self.targets.take_past(&former.targets);
            (self.previous, self.traced) = (former.previous, former.traced);
        }
    }

    /// Bytes on the GPU, without the G-buffer.
    pub fn memory(&self) -> u64 {
        self.targets.memory()
    }

    /// [`Self::memory`] of a view of this size, computed without creating it.
    pub fn bytes(size: UVec2, settings: &TraceSettings) -> u64 {
        TraceTargets::bytes(size, settings)
    }

    pub(crate) fn targets(&self) -> &TraceTargets {
        &self.targets
    }
}

/// Moves a picture in clip space, by pixels to the right and down.
fn shift_of(pixels: Vec2, size: UVec2) -> Mat4 {
    let shift = 2.0 * pixels * Vec2::new(1.0, -1.0) / size.as_vec2();
    Mat4::from_translation(shift.extend(0.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_jitter_moves_the_picture_by_that_part_of_a_pixel() {
        let size = UVec2::new(200, 100);
        let clip_from_world =
            glam::camera::rh::proj::directx::perspective_infinite_reverse(0.8, 2.0, 0.1);
        let pixel_of = |jitter| {
            let clip_from_world = shift_of(jitter, size) * clip_from_world;
            let ndc = clip_from_world.project_point3(Vec3::new(0.2, -0.3, -3.0));
            assert!(ndc.z > 0.0 && ndc.z < 1.0);
            size.as_vec2() * (0.5 + 0.5 * ndc.truncate() * Vec2::new(1.0, -1.0))
        };
        let jitter = Vec2::new(0.25, -0.5);
        let moved = pixel_of(jitter) - pixel_of(Vec2::ZERO);
        assert!((moved - jitter).length() < 1e-4, "{moved}");
    }
}
