//! Bind group layouts and bind groups, with bindings numbered in the order in which they are added.

use crate::gpu::{BindGroup, BufferHandle, Kept, Pipelines, ViewHandle};

/// Builder of a layout; binding `i` is the `i`-th one added.
#[derive(Clone, Debug)]
pub struct LayoutBuilder {
    visibility: wgpu::ShaderStages,
    entries: Vec<wgpu::BindGroupLayoutEntry>,
    skipped: u32,
}

impl LayoutBuilder {
    /// A layout whose bindings all have the given visibility.
    pub fn new(visibility: wgpu::ShaderStages) -> Self {
        Self { visibility, entries: Vec::new(), skipped: 0 }
    }

    /// A layout for compute shaders.
    pub fn compute() -> Self {
        Self::new(wgpu::ShaderStages::COMPUTE)
    }

    /// Skips the next `count` bindings.
    #[must_use]
    pub fn skip(mut self, count: u32) -> Self {
        self.skipped += count;
        self
    }

    /// Adds a binding of any type.
    #[must_use]
    pub fn binding(mut self, ty: wgpu::BindingType) -> Self {
        let binding = self.skipped + self.entries.len() as u32;
        self.entries.push(wgpu::BindGroupLayoutEntry {
            binding,
            visibility: self.visibility,
            ty,
            count: None,
        });
        self
    }

    fn buffer(self, ty: wgpu::BufferBindingType) -> Self {
        self.binding(wgpu::BindingType::Buffer {
            ty,
            has_dynamic_offset: false,
            min_binding_size: None,
        })
    }

    /// `var<uniform>`.
    #[must_use]
    pub fn uniform(self) -> Self {
        self.buffer(wgpu::BufferBindingType::Uniform)
    }

    /// `var<storage, read>`.
    #[must_use]
    pub fn storage(self) -> Self {
        self.buffer(wgpu::BufferBindingType::Storage { read_only: true })
    }

    /// `var<storage, read_write>`.
    #[must_use]
    pub fn storage_mut(self) -> Self {
        self.buffer(wgpu::BufferBindingType::Storage { read_only: false })
    }

    /// A sampled texture.
    #[must_use]
    pub fn texture(
        self,
        view_dimension: wgpu::TextureViewDimension,
        sample_type: wgpu::TextureSampleType,
    ) -> Self {
        self.binding(wgpu::BindingType::Texture {
            sample_type,
            view_dimension,
            multisampled: false,
        })
    }

    /// Filterable `texture_2d<f32>`.
    #[must_use]
    pub fn texture_2d(self) -> Self {
        self.texture(
            wgpu::TextureViewDimension::D2,
            wgpu::TextureSampleType::Float { filterable: true },
        )
    }

    /// `texture_2d<f32>` for `textureLoad` only (any float format).
    #[must_use]
    pub fn texture_2d_unfilterable(self) -> Self {
        self.texture(
            wgpu::TextureViewDimension::D2,
            wgpu::TextureSampleType::Float { filterable: false },
        )
    }

    /// `texture_depth_2d`.
    #[must_use]
    pub fn depth_2d(self) -> Self {
        self.texture(wgpu::TextureViewDimension::D2, wgpu::TextureSampleType::Depth)
    }

    /// `texture_depth_2d_array`.
    #[must_use]
    pub fn depth_2d_array(self) -> Self {
        self.texture(wgpu::TextureViewDimension::D2Array, wgpu::TextureSampleType::Depth)
    }

    /// Filterable `texture_3d<f32>`.
    #[must_use]
    pub fn texture_3d(self) -> Self {
        self.texture(
            wgpu::TextureViewDimension::D3,
            wgpu::TextureSampleType::Float { filterable: true },
        )
    }

    /// A write-only storage texture.
    #[must_use]
    pub fn storage_texture(
        self,
        view_dimension: wgpu::TextureViewDimension,
        format: wgpu::TextureFormat,
    ) -> Self {
        self.binding(wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::WriteOnly,
            format,
            view_dimension,
        })
    }

    /// A 2D texture that is read and written in place; only for formats with one 32-bit channel.
    #[must_use]
    pub fn storage_texture_in_place(self, format: wgpu::TextureFormat) -> Self {
        self.binding(wgpu::BindingType::StorageTexture {
            access: wgpu::StorageTextureAccess::ReadWrite,
            format,
            view_dimension: wgpu::TextureViewDimension::D2,
        })
    }

    /// A filtering sampler.
    #[must_use]
    pub fn sampler(self) -> Self {
        self.binding(wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering))
    }

    /// A comparison sampler.
    #[must_use]
    pub fn sampler_comparison(self) -> Self {
        self.binding(wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Comparison))
    }

    /// Builds the layout, or returns an earlier one with the same entries.
    pub fn build(self, pipelines: &Pipelines, label: &str) -> wgpu::BindGroupLayout {
        pipelines.layout(self.entries, label)
    }
}

/// Builder of a bind group, with resources in the order of its layout.
#[derive(Debug)]
pub struct BindGroupBuilder<'a> {
    layout: &'a wgpu::BindGroupLayout,
    entries: Vec<wgpu::BindGroupEntry<'a>>,
    kept: Vec<Kept>,
    skipped: u32,
}

impl<'a> BindGroupBuilder<'a> {
    /// A bind group of the given layout.
    pub fn new(layout: &'a wgpu::BindGroupLayout) -> Self {
        Self { layout, entries: Vec::new(), kept: Vec::new(), skipped: 0 }
    }

    /// Skips the next `count` bindings.
    #[must_use]
    pub fn skip(mut self, count: u32) -> Self {
        self.skipped += count;
        self
    }

    /// Adds any resource owned by the caller.
    #[must_use]
    pub fn resource(mut self, resource: wgpu::BindingResource<'a>) -> Self {
        let binding = self.skipped + self.entries.len() as u32;
        self.entries.push(wgpu::BindGroupEntry { binding, resource });
        self
    }

    /// A whole buffer.
    #[must_use]
    pub fn buffer<B: BufferHandle>(mut self, buffer: &'a B) -> Self {
        self.kept.extend(buffer.kept());
        self.resource(buffer.raw().as_entire_binding())
    }

    /// A part of a buffer: `bytes` bytes from `offset`, which must be a multiple of 256.
    #[must_use]
    pub fn slice<B: BufferHandle>(mut self, buffer: &'a B, offset: u64, bytes: u64) -> Self {
        self.kept.extend(buffer.kept());
        let size = std::num::NonZeroU64::new(bytes);
        let binding = wgpu::BufferBinding { buffer: buffer.raw(), offset, size };
        self.resource(wgpu::BindingResource::Buffer(binding))
    }

    /// A texture view.
    #[must_use]
    pub fn view<V: ViewHandle>(mut self, view: &'a V) -> Self {
        self.kept.extend(view.kept());
        self.resource(wgpu::BindingResource::TextureView(view.raw()))
    }

    /// A sampler.
    #[must_use]
    pub fn sampler(self, sampler: &'a wgpu::Sampler) -> Self {
        self.resource(wgpu::BindingResource::Sampler(sampler))
    }

    /// Builds the bind group.
    pub fn build(self, device: &wgpu::Device, label: &str) -> BindGroup {
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: self.layout,
            entries: &self.entries,
        });
        BindGroup::new(group, self.kept)
    }
}
