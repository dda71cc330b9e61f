//! All textures of a scene in the layers of one array texture: on WebGPU, a shader cannot select a
//! texture by number in any other way.
//!
//! Only the finest levels are stored: a path tracer filters with its samples. A texture larger than
//! the device's limit is halved until it fits.

use lumivox::gpu::{Texture, TextureView};
use std::collections::BTreeMap;

use etagere::{AtlasAllocator, size2};
use lumivox_scene::{Filter, Sampler, Scene, TextureRef, Wrap};

use super::records::TileRecord;
use crate::scene::{Alpha, Encoding, Level, mip_chain};
use crate::{Gpu, RenderError};

/// `TILE_CLAMP` of the shaders for the first axis; the bits of the second axis are two positions
/// higher.
pub(crate) const TILE_CLAMP: u32 = 1;
pub(crate) const TILE_MIRROR: u32 = 2;
pub(crate) const TILE_NEAREST: u32 = 16;
pub(crate) const TILE_COLOR: u32 = 32;
pub(crate) const TILE_PRESENT: u32 = 64;

/// The edge of a layer, unless a texture is larger.
const LAYER_EDGE: u32 = 4096;

/// The layout of the textures in the atlas.
#[derive(Debug)]
pub(super) struct Atlas {
    pub(super) view: TextureView,
    /// The tile of each texture, keyed by its number and whether it contains colours.
    tiles: BTreeMap<(usize, bool), TileRecord>,
    samplers: Vec<Sampler>,
}

impl Atlas {
    /// Uploads the textures in `used`, each with whether it contains colours.
    pub(super) fn new(
        gpu: &Gpu,
        scene: &Scene,
        used: impl Iterator<Item = (TextureRef, bool)>,
    ) -> Result<Self, RenderError> {
        let limits = gpu.device.limits();
        let most = limits.max_texture_dimension_2d;
        let mut places: BTreeMap<(usize, bool), TileRecord> = BTreeMap::new();
        for (reference, is_color) in used {
            let texture = &scene.textures[reference.texture];
            let shrink = texture.width.max(texture.height).div_ceil(most).next_power_of_two();
            let size = [texture.width, texture.height].map(|edge| (edge / shrink).max(1));
            let tile = TileRecord { size, ..TileRecord::default() };
            places.insert((reference.texture, is_color), tile);
        }
        let area: f64 = places.values().map(|t| f64::from(t.size[0]) * f64::from(t.size[1])).sum();
        let largest = places.values().flat_map(|tile| tile.size).max().unwrap_or(1);
        // A margin for the gaps between rectangles.
        let edge = ((1.2 * area).sqrt().ceil() as u32).min(LAYER_EDGE).max(largest).min(most);

        let mut order: Vec<_> = places.values_mut().collect();
        order.sort_by_key(|tile| std::cmp::Reverse(tile.size[1]));
        let mut layers: Vec<AtlasAllocator> = Vec::new();
        for tile in order {
            let size = size2(tile.size[0] as i32, tile.size[1] as i32);
            let mut found = layers.iter_mut().enumerate().find_map(|(layer, allocator)| {
                allocator.allocate(size).map(|allocation| (layer, allocation))
            });
            if found.is_none() {
                let mut allocator = AtlasAllocator::new(size2(edge as i32, edge as i32));
                found = allocator.allocate(size).map(|allocation| (layers.len(), allocation));
                layers.push(allocator);
            }
            let Some((layer, allocation)) = found else { continue };
            let corner = allocation.rectangle.min;
            tile.origin = [corner.x as u32, corner.y as u32];
            tile.layer = layer as u32;
        }
        let layer_count = layers.len().max(1) as u32;
        if layer_count > limits.max_texture_array_layers {
            return Err(RenderError::Limit {
                what: "the path tracer's copy of the textures".to_owned(),
                needed: layer_count.into(),
                unit: "texture layers",
                limit: "max_texture_array_layers",
                available: limits.max_texture_array_layers.into(),
                remedy: "load the scene with smaller textures (--texture-memory)".to_owned(),
            });
        }
        let texture = Texture::new(
            &gpu.device,
            &wgpu::TextureDescriptor {
                label: Some("atlas"),
                size: wgpu::Extent3d {
                    width: edge,
                    height: edge,
                    depth_or_array_layers: layer_count,
                },
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: wgpu::TextureFormat::Rgba8Unorm,
                usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
                view_formats: &[],
            },
        );
        for (&(index, is_color), tile) in &places {
            write(gpu, &texture, scene, index, is_color, tile);
        }
        let view = texture.create_view(&wgpu::TextureViewDescriptor {
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        });
        let samplers = scene.textures.iter().map(|texture| texture.sampler).collect();
        Ok(Self { view, tiles: places, samplers })
    }

    /// The tile of a texture, with its sampling.
    pub(super) fn tile(&self, reference: TextureRef, is_color: bool) -> TileRecord {
        let sampler = self.samplers[reference.texture];
        let wrap = |wrap, shift: u32| match wrap {
            Wrap::Repeat => 0,
            Wrap::ClampToEdge => TILE_CLAMP << shift,
            Wrap::MirroredRepeat => TILE_MIRROR << shift,
        };
        let nearest = if sampler.magnify == Filter::Nearest { TILE_NEAREST } else { 0 };
        let color = if is_color { TILE_COLOR } else { 0 };
        let bits = wrap(sampler.wrap_u, 0) | wrap(sampler.wrap_v, 2) | nearest | color;
        TileRecord { bits: bits | TILE_PRESENT, ..self.tiles[&(reference.texture, is_color)] }
    }
}

fn write(
    gpu: &Gpu,
    atlas: &Texture,
    scene: &Scene,
    index: usize,
    is_color: bool,
    tile: &TileRecord,
) {
    let [width, height] = tile.size;
    let texture = &scene.textures[index];
    let whole = Level { width, height, rgba8: Vec::new() };
    let shrunk = (texture.width != width || texture.height != height).then(|| {
        let encoding = if is_color { Encoding::Color } else { Encoding::Data };
        let levels = mip_chain(texture, encoding, Alpha::Data);
        levels.into_iter().find(|level| level.width == width && level.height == height)
    });
    let level = shrunk.flatten().unwrap_or(whole);
    let texels = if level.rgba8.is_empty() { &texture.rgba8 } else { &level.rgba8 };
    gpu.queue.write_texture(
        wgpu::TexelCopyTextureInfo {
            texture: atlas,
            mip_level: 0,
            origin: wgpu::Origin3d { x: tile.origin[0], y: tile.origin[1], z: tile.layer },
            aspect: wgpu::TextureAspect::All,
        },
        texels,
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(4 * width),
            rows_per_image: None,
        },
        wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
    );
}
