//! The G-buffer, rendered by the caller, from which the cones start.

use crate::gpu::{BindGroup, BindGroupBuilder, Buffer, LayoutBuilder, Pipelines};
use crate::mounted::{Mounted, Resource};

/// The x in [`GBufferViews::motion`] of surfaces that are static in the world, so that only the
/// camera moves them in the picture. A pass that draws moving objects clears its target to this.
pub const AS_THE_CAMERA: f32 = 1024.0;

/// Views of the G-buffer's textures, all with the picture's size.
#[derive(Clone, Copy, Debug)]
pub struct GBufferViews<'a> {
    /// `Depth32Float`, reversed z; 0 for pixels without surface.
    pub depth: &'a wgpu::TextureView,
    /// Octahedral shading normal in xy and geometric normal in zw, both towards the camera
    /// (`Rgba16Float`).
    pub normals: &'a wgpu::TextureView,
    /// Diffuse albedo in rgb; in a, 1 minus the strength of a clear coat, so 1 without a coat
    /// (`Rgba8UnormSrgb` or any other float format).
    pub diffuse: &'a wgpu::TextureView,
    /// Specular reflectance at normal incidence in rgb, perceptual roughness in a.
    pub specular: &'a wgpu::TextureView,
    /// Emitted radiance in rgb; the coat's perceptual roughness in a (`Rgba16Float`).
    pub emission: &'a wgpu::TextureView,
    /// In xy the position of a pixel's surface in the picture minus its position in the previous
    /// frame, as a share of the picture, x to the right, y down (`Rg16Float`); [`AS_THE_CAMERA`]
    /// for static surfaces. `None` if only the camera moves. It is read only if light of earlier
    /// frames is reused ([`TraceSettings::temporal`](crate::TraceSettings::temporal)).
    pub motion: Option<&'a wgpu::TextureView>,
}

/// The textures of a G-buffer.
#[derive(Clone, Copy, Debug)]
pub enum GBuffer<'a> {
    /// Textures in Lumivox's own layout.
    Views(GBufferViews<'a>),
    /// The resources of the caller's own module ([`crate::GiConfig::gbuffer`]), in the order of its
    /// bindings. wgpu reports resources that do not fit the bindings.
    Own(&'a [Resource]),
}

impl<'a> From<GBufferViews<'a>> for GBuffer<'a> {
    fn from(views: GBufferViews<'a>) -> Self {
        Self::Views(views)
    }
}

impl<'a> From<&'a [Resource]> for GBuffer<'a> {
    fn from(resources: &'a [Resource]) -> Self {
        Self::Own(resources)
    }
}

impl GBuffer<'_> {
    /// `true` if it has a texture of motion in Lumivox's layout.
    pub(super) fn has_motion(&self) -> bool {
        matches!(self, Self::Views(GBufferViews { motion: Some(_), .. }))
    }

    /// Group 3, with the uniform of the camera.
    pub(super) fn bind(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        camera: &Buffer,
    ) -> BindGroup {
        let group = BindGroupBuilder::new(layout).buffer(camera);
        let group = match self {
            Self::Views(views) => group
                .view(views.depth)
                .view(views.normals)
                .view(views.diffuse)
                .view(views.specular)
                .view(views.emission)
                // The placeholder is not read.
                .view(views.motion.unwrap_or(views.normals)),
            Self::Own(resources) => {
                resources.iter().fold(group, |group, own| group.resource(own.binding()))
            }
        };
        group.build(device, "G-buffer")
    }
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
