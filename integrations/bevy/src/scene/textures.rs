//! Textures for voxels: the app's own image if it has mips, otherwise a small copy with mips.
//!
//! A voxel needs the mean over its surface, so it reads coarse mips. Images from PNG files have no
//! mips, and alpha with a cutoff has to be compared before it is averaged. Such images get a copy
//! of at most [`MAX_EDGE`] texels along an edge.

use bevy::platform::collections::{HashMap, HashSet};
use bevy::prelude::*;
use bevy::render::texture::GpuImage;
use lumivox::gpu::pipelines::DrawPlan;
use lumivox::gpu::{LayoutBuilder, Pipelines, ShaderLibrary, uniform_buffer};
use lumivox::wgpu;

/// Texels along the longest edge of a copy. The finest voxels are seldom smaller than its texels.
const MAX_EDGE: u32 = 256;
/// The most source texels, along an edge, that are averaged for one texel of the copy.
const MAX_FOOTPRINT: u32 = 16;

/// The use of a texture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum TextureUse {
    /// Colour, with coverage in alpha, which is compared with the cutoff if there is one.
    Color { cutoff: Option<f32> },
    /// Emitted light, which may be brighter than one.
    Emission,
}

/// The copies that are in use, and views of images that need none.
#[derive(Resource, Default)]
pub(crate) struct TextureCopies {
    copies: HashMap<(AssetId<Image>, u64), Copy>,
    round: u32,
}

#[derive(Debug)]
struct Copy {
    source: wgpu::TextureView,
    view: wgpu::TextureView,
    used: u32,
}

impl TextureCopies {
    /// Drops the copies of changed images, so that the next round makes them again.
    pub(crate) fn forget(&mut self, images: &HashSet<AssetId<Image>>) {
        self.copies.retain(|(image, _), _| !images.contains(image));
    }
}

/// Makes textures for voxels.
pub(crate) struct Prepared<'a> {
    pub(crate) pipelines: &'a Pipelines,
    pub(crate) queue: &'a wgpu::Queue,
    pub(crate) copies: &'a mut TextureCopies,
}

/// `Reduction` of `reduce.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, bytemuck::Pod, bytemuck::Zeroable)]
struct Reduction {
    source_size: [u32; 2],
    size: [u32; 2],
    cutoff: f32,
    max_footprint: u32,
    padding: [u32; 2],
}

impl Prepared<'_> {
    /// Starts a round in which all textures in use are requested.
    pub(crate) fn begin(&mut self) {
        self.copies.round = self.copies.round.wrapping_add(1);
    }

    /// Drops the copies that were not requested in this round.
    pub(crate) fn end(&mut self) {
        let round = self.copies.round;
        self.copies.copies.retain(|_, copy| copy.used == round);
    }

    /// A view with mips, and a sampler; `None` if the image is not a 2D texture of floats.
    pub(crate) fn texture(
        &mut self,
        id: AssetId<Image>,
        image: &GpuImage,
        used: TextureUse,
    ) -> Option<(wgpu::TextureView, wgpu::Sampler)> {
        let texture = &image.texture;
        let format = texture.format();
        let sample_type = format.sample_type(None, Some(self.pipelines.device().features()))?;
        let is_float = matches!(sample_type, wgpu::TextureSampleType::Float { .. });
        let is_flat = texture.dimension() == wgpu::TextureDimension::D2
            && texture.depth_or_array_layers() == 1
            && texture.sample_count() == 1;
        if !is_float || !is_flat {
            return None;
        }
        let sampler = (*image.sampler).clone();
        let source: wgpu::TextureView = (*image.texture_view).clone();
        let cutoff = match used {
            TextureUse::Color { cutoff } => cutoff,
            TextureUse::Emission => None,
        };
        let is_small = texture.width().max(texture.height()) == 1;
        let has_mips = texture.mip_level_count() > 1 || is_small;
        let is_filterable = sample_type == wgpu::TextureSampleType::Float { filterable: true };
        let key = (id, cutoff.map_or(0, |cutoff| 1 + u64::from(cutoff.to_bits())));
        let round = self.copies.round;
        if let Some(copy) = self.copies.copies.get_mut(&key)
            && copy.source == source
        {
            copy.used = round;
            return Some((copy.view.clone(), sampler));
        }
        // A new view, so that an image redrawn into the same texture counts as changed.
        if cutoff.is_none() && has_mips && is_filterable {
            let texture: &wgpu::Texture = texture;
            let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
            self.copies.copies.insert(key, Copy { source, view: view.clone(), used: round });
            return Some((view, sampler));
        }
        let is_wide = !format.is_srgb() && format.block_copy_size(None).unwrap_or(4) > 4;
        let copy_format = if is_wide {
            wgpu::TextureFormat::Rgba16Float
        } else {
            wgpu::TextureFormat::Rgba8UnormSrgb
        };
        let view = self.reduce(texture, &source, copy_format, cutoff)?;
        self.copies.copies.insert(key, Copy { source, view: view.clone(), used: round });
        Some((view, sampler))
    }

    /// Makes a copy with mips, each the mean of the one above.
    fn reduce(
        &self,
        texture: &wgpu::Texture,
        source: &wgpu::TextureView,
        format: wgpu::TextureFormat,
        cutoff: Option<f32>,
    ) -> Option<wgpu::TextureView> {
        let device = self.pipelines.device();
        let source_size = [texture.width(), texture.height()];
        let longest = source_size[0].max(source_size[1]);
        let divisor = longest.div_ceil(MAX_EDGE).next_power_of_two();
        let size = source_size.map(|edge| (edge / divisor).max(1));
        let levels = size[0].max(size[1]).ilog2() + 1;
        let copy = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("texture for voxels"),
            size: wgpu::Extent3d { width: size[0], height: size[1], depth_or_array_layers: 1 },
            mip_level_count: levels,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let level_view = |level| {
            copy.create_view(&wgpu::TextureViewDescriptor {
                base_mip_level: level,
                mip_level_count: Some(1),
                ..wgpu::TextureViewDescriptor::default()
            })
        };
        let layout = LayoutBuilder::new(wgpu::ShaderStages::FRAGMENT)
            .uniform()
            .texture_2d_unfilterable()
            .build(self.pipelines, "reduce");
        let mut library = ShaderLibrary::default();
        library.add("bevy::reduce", include_str!("reduce.wgsl"));
        let shader = self.pipelines.shader(&library, "bevy::reduce").ok()?;
        let plan = DrawPlan {
            fragment: Some(shader.entry("reduce").ok()?),
            targets: vec![Some(format.into())],
            groups: vec![layout.clone()],
            ..DrawPlan::new(&shader, "cover").ok()?
        };
        let pipeline = self.pipelines.draw(plan);
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let mut from = (source.clone(), source_size);
        // Uniform buffers are reused once dropped, so they must live until the work is submitted.
        let mut uniforms = Vec::new();
        for level in 0..levels {
            let size = size.map(|edge| (edge >> level).max(1));
            let reduction = Reduction {
                source_size: from.1,
                size,
                // Only the first level compares alpha.
                cutoff: cutoff.filter(|_| level == 0).unwrap_or(-1.0),
                max_footprint: MAX_FOOTPRINT,
                padding: [0; 2],
            };
            let uniform = uniform_buffer(device, "reduction", &reduction);
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("reduce"),
                layout: &layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: uniform.as_entire_binding() },
                    wgpu::BindGroupEntry {
                        binding: 1,
                        resource: wgpu::BindingResource::TextureView(&from.0),
                    },
                ],
            });
            let to = level_view(level);
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("reduce"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &to,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations {
                        load: wgpu::LoadOp::Clear(wgpu::Color::TRANSPARENT),
                        store: wgpu::StoreOp::Store,
                    },
                })],
                ..wgpu::RenderPassDescriptor::default()
            });
            pass.set_pipeline(&pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.draw(0..3, 0..1);
            drop(pass);
            from = (to, size);
            uniforms.push(uniform);
        }
        self.queue.submit([encoder.finish()]);
        drop(uniforms);
        Some(copy.create_view(&wgpu::TextureViewDescriptor::default()))
    }
}
