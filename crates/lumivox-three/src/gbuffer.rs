//! The shader module with which cones read the page's G-buffer.

use lumivox::hooks::Mounted;
use lumivox::wgpu;

/// The module, for a renderer whose depth is 1 at the near plane (`is_reversed`) or 0 there.
pub fn module(is_reversed: bool) -> Mounted {
    let texture = |sample_type| wgpu::BindingType::Texture {
        sample_type,
        view_dimension: wgpu::TextureViewDimension::D2,
        multisampled: false,
    };
    let color = texture(wgpu::TextureSampleType::Float { filterable: false });
    let text = include_str!("gbuffer.wgsl");
    // Imports must come first in a module.
    let (imports, rest) = text.split_once("\n@group").unwrap_or((text, ""));
    let source = format!("{imports}\nconst IS_REVERSED: bool = {is_reversed};\n\n@group{rest}");
    Mounted::new(source, [texture(wgpu::TextureSampleType::Depth), color, color, color])
}

#[cfg(test)]
mod tests {
    use lumivox::{Gi, GiConfig, Grid};

    use super::*;

    #[test]
    fn cone_shaders_link_with_the_gbuffer_module() {
        let (device, queue) = pollster::block_on(lumivox::gpu::open_device()).unwrap();
        let grid = Grid::fit(glam::Vec3::ZERO, glam::Vec3::ONE, 16, glam::Vec3::ZERO).unwrap();
        for is_reversed in [false, true] {
            let gbuffer = Some(module(is_reversed));
            Gi::new(&device, &queue, GiConfig { gbuffer, ..GiConfig::new(grid) }).unwrap();
        }
    }
}
