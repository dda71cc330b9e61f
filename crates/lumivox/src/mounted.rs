//! WGSL modules of the caller's in the place of Lumivox's own, with what they bind.

use std::borrow::Cow;

/// A WGSL module of the caller's that takes the place of one of Lumivox's, so that Lumivox reads the caller's textures
/// as they are ([`GiConfig::gbuffer`](crate::GiConfig::gbuffer),
/// [`GiConfig::shadow_maps`](crate::GiConfig::shadow_maps)).
///
/// It has the functions of the module that it replaces, and declares bindings of its own, numbered from the first free
/// one of the group on. It may import Lumivox's modules.
#[derive(Clone, Debug, PartialEq)]
pub struct Mounted {
    /// The source, in WGSL with imports ([`ShaderLibrary`](crate::gpu::ShaderLibrary)).
    pub source: Cow<'static, str>,
    /// What it binds, in the order of the bindings.
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

/// What a [`Mounted`] module's binding is given.
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
