//! The caller's WGSL modules that replace Lumivox's own, with their bindings.

use std::borrow::Cow;

/// A caller's WGSL module that replaces one of Lumivox's, so that Lumivox reads the caller's
/// textures in their own format ([`GiConfig::gbuffer`](crate::GiConfig::gbuffer),
/// [`GiConfig::shadow_maps`](crate::GiConfig::shadow_maps)).
///
/// It defines the functions of the module that it replaces, and declares its own bindings, numbered
/// from the first free one of the group. It may import Lumivox's modules.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounted {
    /// The source, in WGSL with imports ([`ShaderLibrary`](crate::gpu::ShaderLibrary)).
    pub source: Cow<'static, str>,
    /// Types of the module's bindings, in order.
    pub bindings: Vec<wgpu::BindingType>,
}

impl Mounted {
    /// A module and its bindings, in order.
    pub fn new(
        source: impl Into<Cow<'static, str>>,
        bindings: impl Into<Vec<wgpu::BindingType>>,
    ) -> Self {
        Self { source: source.into(), bindings: bindings.into() }
    }
}

/// A resource for a binding of a [`Mounted`] module.
#[derive(Clone, Debug, PartialEq)]
pub enum Resource {
    /// A whole buffer.
    Buffer(wgpu::Buffer),
    /// A texture.
    View(wgpu::TextureView),
    /// A sampler.
    Sampler(wgpu::Sampler),
}

impl Resource {
    pub(crate) fn binding(&self) -> wgpu::BindingResource<'_> {
        match self {
            Self::Buffer(buffer) => buffer.as_entire_binding(),
            Self::View(view) => wgpu::BindingResource::TextureView(view),
            Self::Sampler(sampler) => wgpu::BindingResource::Sampler(sampler),
        }
    }
}

impl From<wgpu::Buffer> for Resource {
    fn from(buffer: wgpu::Buffer) -> Self {
        Self::Buffer(buffer)
    }
}

impl From<wgpu::TextureView> for Resource {
    fn from(view: wgpu::TextureView) -> Self {
        Self::View(view)
    }
}

impl From<wgpu::Sampler> for Resource {
    fn from(sampler: wgpu::Sampler) -> Self {
        Self::Sampler(sampler)
    }
}
