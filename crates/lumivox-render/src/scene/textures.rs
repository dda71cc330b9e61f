//! Textures on the GPU with all their mips, uploaded once per use.

use lumivox::gpu::{Texture, TextureView};
use std::collections::HashMap;

use lumivox_scene::{Filter, Sampler, Scene, TextureRef, Wrap};

use super::mips::{Alpha, Encoding, Level, mip_chain};
use super::sheen;
use crate::Gpu;

/// The key of a texture's use: its number, and the interpretation of its bytes.
type Key = (usize, Encoding, AlphaKey);

/// [`Alpha`] with the cutoff as bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
enum AlphaKey {
    Data,
    Coverage,
    Mask(u32),
}

/// Uploads textures.
#[derive(Debug)]
pub(super) struct TextureUpload<'a> {
    gpu: &'a Gpu,
    scene: &'a Scene,
    white: TextureView,
    sheen_albedo: Option<TextureView>,
    textures: HashMap<Key, TextureView>,
    samplers: HashMap<Sampler, wgpu::Sampler>,
    /// Bytes of all textures so far.
    pub(super) bytes: u64,
}

impl<'a> TextureUpload<'a> {
    pub(super) fn new(gpu: &'a Gpu, scene: &'a Scene) -> Self {
        let white = Level { width: 1, height: 1, rgba8: vec![255; 4] };
        Self {
            gpu,
            scene,
            white: create_texture(gpu, "white", Encoding::Data, &[white]),
            sheen_albedo: None,
            textures: HashMap::new(),
            samplers: HashMap::new(),
            bytes: 4,
        }
    }

    /// A texture with its mips; `None` gives a white texel.
    pub(super) fn texture(
        &mut self,
        reference: Option<TextureRef>,
        encoding: Encoding,
        alpha: Alpha,
    ) -> TextureView {
        let Some(reference) = reference else { return self.white.clone() };
        let alpha_key = match alpha {
            Alpha::Data => AlphaKey::Data,
            Alpha::Coverage => AlphaKey::Coverage,
            Alpha::Mask(cutoff) => AlphaKey::Mask(cutoff.to_bits()),
        };
        let key = (reference.texture, encoding, alpha_key);
        if let Some(view) = self.textures.get(&key) {
            return view.clone();
        }
        let texture = &self.scene.textures[reference.texture];
        let mut levels = mip_chain(texture, encoding, alpha);
        let most = self.gpu.device.limits().max_texture_dimension_2d;
        let skipped = levels.iter().position(|level| level.width.max(level.height) <= most);
        let skipped = skipped.unwrap_or(levels.len() - 1);
        if skipped > 0 {
            tracing::warn!(
                "texture \"{}\" of {}x{} is shown at {}x{}: this device has no textures above {most}",
                texture.name,
                texture.width,
                texture.height,
                levels[skipped].width,
                levels[skipped].height
            );
            levels.drain(..skipped);
        }
        self.bytes += levels.iter().map(|level| level.rgba8.len() as u64).sum::<u64>();
        let view = create_texture(self.gpu, &texture.name, encoding, &levels);
        self.textures.insert(key, view.clone());
        view
    }

    /// The sampler of a texture; `None` gives an arbitrary sampler.
    pub(super) fn sampler(&mut self, reference: Option<TextureRef>) -> wgpu::Sampler {
        let sampler =
            reference.map_or(Sampler::default(), |r| self.scene.textures[r.texture].sampler);
        self.sampler_of(sampler)
    }

    fn sampler_of(&mut self, sampler: Sampler) -> wgpu::Sampler {
        let device = &self.gpu.device;
        self.samplers.entry(sampler).or_insert_with(|| create_sampler(device, sampler)).clone()
    }

    /// The table of [`sheen`] if a material has any, otherwise an arbitrary texture; and its
    /// sampler.
    pub(super) fn sheen_albedo(&mut self, is_used: bool) -> (TextureView, wgpu::Sampler) {
        let edge =
            Sampler { wrap_u: Wrap::ClampToEdge, wrap_v: Wrap::ClampToEdge, ..Sampler::default() };
        let sampler = self.sampler_of(edge);
        if !is_used {
            return (self.white.clone(), sampler);
        }
        let (gpu, bytes) = (self.gpu, &mut self.bytes);
        let table = self.sheen_albedo.get_or_insert_with(|| {
            let rgba8: Vec<u8> = sheen::table().into_iter().flat_map(|byte| [byte; 4]).collect();
            *bytes += rgba8.len() as u64;
            let level = Level { width: sheen::EDGE, height: sheen::EDGE, rgba8 };
            create_texture(gpu, "sheen albedo", Encoding::Data, &[level])
        });
        (table.clone(), sampler)
    }
}

fn create_texture(gpu: &Gpu, label: &str, encoding: Encoding, levels: &[Level]) -> TextureView {
    let extent = |level: &Level| wgpu::Extent3d {
        width: level.width,
        height: level.height,
        depth_or_array_layers: 1,
    };
    let texture = Texture::new(
        &gpu.device,
        &wgpu::TextureDescriptor {
            label: Some(label),
            size: extent(&levels[0]),
            mip_level_count: levels.len() as u32,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: match encoding {
                Encoding::Color => wgpu::TextureFormat::Rgba8UnormSrgb,
                Encoding::Data => wgpu::TextureFormat::Rgba8Unorm,
            },
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        },
    );
    for (index, level) in levels.iter().enumerate() {
        gpu.queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &texture,
                mip_level: index as u32,
                origin: wgpu::Origin3d::ZERO,
                aspect: wgpu::TextureAspect::All,
            },
            &level.rgba8,
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(4 * level.width),
                rows_per_image: None,
            },
            extent(level),
        );
    }
    texture.view()
}

fn create_sampler(device: &wgpu::Device, sampler: Sampler) -> wgpu::Sampler {
    let wrap = |wrap| match wrap {
        Wrap::Repeat => wgpu::AddressMode::Repeat,
        Wrap::MirroredRepeat => wgpu::AddressMode::MirrorRepeat,
        Wrap::ClampToEdge => wgpu::AddressMode::ClampToEdge,
    };
    let filter = |filter| match filter {
        Filter::Nearest => wgpu::FilterMode::Nearest,
        Filter::Linear => wgpu::FilterMode::Linear,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("texture"),
        address_mode_u: wrap(sampler.wrap_u),
        address_mode_v: wrap(sampler.wrap_v),
        mag_filter: filter(sampler.magnify),
        min_filter: filter(sampler.minify),
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}
