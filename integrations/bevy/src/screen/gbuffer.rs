//! Bevy's deferred G-buffer as Lumivox reads it.

use lumivox::hooks::Mounted;
use lumivox::wgpu;

/// The module that reads it (`gbuffer.wgsl`), with its bindings.
pub(crate) fn module() -> Mounted {
    let texture = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let float = wgpu::TextureSampleType::Float { filterable: false };
    let place = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    Mounted::new(
        include_str!("gbuffer.wgsl"),
        [
            texture(wgpu::TextureSampleType::Uint),
            texture(wgpu::TextureSampleType::Depth),
            texture(float),
            place,
        ],
    )
}
