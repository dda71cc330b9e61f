//! The page's textures as textures of wgpu, without copies.

use js_sys::Reflect;
use wasm_bindgen::{JsCast as _, JsValue};

use crate::error::PageError;

/// The use of a texture of the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Role {
    /// The depth of the G-buffer.
    Depth,
    /// One of the G-buffer's other textures.
    GBuffer,
    /// An image of a material.
    Image,
}

/// A view of all of a `GPUTexture` of this device.
///
/// # Errors
/// When it is not a texture, or its format does not fit the role.
pub fn view(
    device: &wgpu::Device,
    texture: &JsValue,
    role: Role,
) -> Result<wgpu::TextureView, PageError> {
    let number = |name: &str| {
        let value = Reflect::get(texture, &name.into()).ok()?.as_f64()?;
        Some(value as u32)
    };
    let text = |name: &str| Reflect::get(texture, &name.into()).ok()?.as_string();
    let (Some(width), Some(height), Some(format)) =
        (number("width"), number("height"), text("format"))
    else {
        return Err(PageError::value("this is not a GPUTexture"));
    };
    let format = match (role, format.as_str()) {
        (Role::Depth, "depth32float") => wgpu::TextureFormat::Depth32Float,
        (Role::GBuffer, "rgba16float") => wgpu::TextureFormat::Rgba16Float,
        (Role::Image, format) => image_format(format)?,
        (_, other) => {
            return Err(PageError::value(format!(
                "a texture of the G-buffer is {other}, but depth is depth32float and the others are rgba16float"
            )));
        }
    };
    let descriptor = wgpu::TextureDescriptor {
        label: None,
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: number("mipLevelCount").unwrap_or(1),
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING,
        view_formats: &[],
    };
    let handle = texture.clone().unchecked_into::<wgpu::webgpu::GpuTexture>();
    let texture = device.create_texture_from_webgpu_handle(handle, &descriptor, None);
    Ok(texture.create_view(&wgpu::TextureViewDescriptor::default()))
}

/// The formats that a shader can filter without a feature.
fn image_format(name: &str) -> Result<wgpu::TextureFormat, PageError> {
    use wgpu::TextureFormat as F;
    let known = [
        ("rgba8unorm", F::Rgba8Unorm),
        ("rgba8unorm-srgb", F::Rgba8UnormSrgb),
        ("bgra8unorm", F::Bgra8Unorm),
        ("bgra8unorm-srgb", F::Bgra8UnormSrgb),
        ("rgba16float", F::Rgba16Float),
        ("rg11b10ufloat", F::Rg11b10Ufloat),
        ("rgb9e5ufloat", F::Rgb9e5Ufloat),
        ("bc1-rgba-unorm", F::Bc1RgbaUnorm),
        ("bc1-rgba-unorm-srgb", F::Bc1RgbaUnormSrgb),
        ("bc3-rgba-unorm", F::Bc3RgbaUnorm),
        ("bc3-rgba-unorm-srgb", F::Bc3RgbaUnormSrgb),
        ("bc7-rgba-unorm", F::Bc7RgbaUnorm),
        ("bc7-rgba-unorm-srgb", F::Bc7RgbaUnormSrgb),
        ("etc2-rgb8unorm", F::Etc2Rgb8Unorm),
        ("etc2-rgb8unorm-srgb", F::Etc2Rgb8UnormSrgb),
        ("etc2-rgba8unorm", F::Etc2Rgba8Unorm),
        ("etc2-rgba8unorm-srgb", F::Etc2Rgba8UnormSrgb),
    ];
    let found = known.iter().find(|(known, _)| *known == name).map(|(_, format)| *format);
    let astc = || {
        let channel = if name.ends_with("-srgb") {
            wgpu::AstcChannel::UnormSrgb
        } else {
            wgpu::AstcChannel::Unorm
        };
        let block = wgpu::AstcBlock::B4x4;
        name.starts_with("astc-4x4-unorm").then_some(F::Astc { block, channel })
    };
    found.or_else(astc).ok_or_else(|| {
        PageError::value(format!(
            "an image is {name}; use one of 8-bit RGBA, of half floats or of compressed blocks"
        ))
    })
}
