//! Sending pictures from the worker to the window.
//!
//! If the window draws with the worker's device, a picture is a texture, copied on the GPU and
//! bound directly. Otherwise it passes through main memory. The worker decides for each picture, by
//! the device that the window has last sent.

use std::sync::Arc;

use egui::TextureId;
use glam::UVec2;
use lumivox_explorer::Explorer;
use lumivox_render::{Gpu, GpuId, RenderError};

/// Number of pictures on the screen: the rendering, and the one it is compared with.
pub const PICTURES: usize = 2;

/// A picture's pixels.
#[derive(Clone, Debug)]
pub enum Pixels {
    /// In main memory, row by row from the top.
    InMemory(Vec<[u8; 4]>),
    /// In a texture on a device. The worker reuses the texture once it has the only reference.
    OnDevice(GpuId, Arc<wgpu::Texture>),
}

/// A picture for the screen.
#[derive(Clone, Debug)]
pub struct Shown {
    /// The picture's number.
    pub serial: u64,
    /// Width and height, px.
    pub size: UVec2,
    /// Its pixels.
    pub pixels: Pixels,
    /// Averaged frames, or samples of the reference.
    pub frames: u32,
}

/// The worker's side.
#[derive(Default)]
pub struct Screen {
    /// The device that the window draws with; `None` before there is one.
    device: Option<GpuId>,
    /// Textures for pictures: one being written, one published, one being drawn, and as many for
    /// another view.
    textures: Vec<Arc<wgpu::Texture>>,
}

impl Screen {
    /// Sets the device that the window draws with.
    pub fn draw_with(&mut self, device: GpuId) {
        self.textures.clear();
        self.device = Some(device);
    }

    /// The picture of an explorer's frames so far, at an exposure in stops; `None` if there are no
    /// frames.
    ///
    /// # Errors
    /// When the device fails.
    pub async fn picture(
        &mut self,
        explorer: &mut Explorer,
        stops: f32,
    ) -> Result<Option<Pixels>, RenderError> {
        let gpu = explorer.gpu().clone();
        let Some(renderer) = explorer.renderer_mut() else { return Ok(None) };
        if self.device != Some(gpu.id) {
            return Ok(Some(Pixels::InMemory(renderer.screen(stops).await?)));
        }
        renderer.draw_screen(stops).await?;
        let drawn = renderer.screen_texture();
        let texture = self.free_texture(&gpu, drawn.size());
        let mut encoder =
            gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (from, to) = (drawn.as_image_copy(), texture.as_image_copy());
        encoder.copy_texture_to_texture(from, to, drawn.size());
        gpu.queue.submit([encoder.finish()]);
        gpu.check("bringing the picture to the screen")?;
        Ok(Some(Pixels::OnDevice(gpu.id, texture)))
    }

    /// A texture that is not in use.
    fn free_texture(&mut self, gpu: &Gpu, size: wgpu::Extent3d) -> Arc<wgpu::Texture> {
        self.textures.retain(|texture| texture.size() == size);
        // Only the worker could clone this reference, so the texture stays free.
        let is_free = |texture: &&Arc<wgpu::Texture>| Arc::strong_count(texture) == 1;
        if let Some(texture) = self.textures.iter().find(is_free) {
            return texture.clone();
        }
        let texture = Arc::new(new_texture(gpu, size));
        self.textures.push(texture.clone());
        texture
    }
}

/// The window's side: the pictures' textures, with their ids in egui.
#[derive(Default)]
pub struct Textures {
    shown: [Option<Bound>; PICTURES],
    changed: Vec<TextureId>,
}

/// A picture that is bound to egui.
struct Bound {
    texture: wgpu::Texture,
    id: TextureId,
    serial: u64,
    /// `true` if the window created it, for a picture from main memory.
    is_own: bool,
}

impl Textures {
    /// Ids of the textures that have changed since the last call.
    pub fn take_changed(&mut self) -> Vec<TextureId> {
        std::mem::take(&mut self.changed)
    }

    /// The number of the newest picture; 0 if there is none.
    pub fn newest(&self) -> u64 {
        self.shown.iter().flatten().map(|bound| bound.serial).max().unwrap_or(0)
    }

    /// Binds a picture to egui, under the id of the previous picture in its place; `None` if it
    /// belongs to another device.
    pub fn bind(
        &mut self,
        place: usize,
        picture: &Shown,
        gpu: &Gpu,
        painter: &mut egui_wgpu::Renderer,
    ) -> Option<TextureId> {
        let old = self.shown[place].as_ref();
        if let Some(old) = old.filter(|old| old.serial == picture.serial) {
            return Some(old.id);
        }
        let (texture, is_own) = match &picture.pixels {
            Pixels::OnDevice(device, _) if *device != gpu.id => return None,
            Pixels::OnDevice(_, texture) => ((**texture).clone(), false),
            Pixels::InMemory(pixels) => (upload(gpu, picture.size, pixels, old), true),
        };
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let filter = wgpu::FilterMode::Linear;
        let id = match old.map(|old| old.id) {
            None => painter.register_native_texture(&gpu.device, &view, filter),
            Some(id) => {
                painter.update_egui_texture_from_wgpu_texture(&gpu.device, &view, filter, id);
                id
            }
        };
        self.changed.push(id);
        self.shown[place] = Some(Bound { texture, id, serial: picture.serial, is_own });
        Some(id)
    }
}

/// Uploads pixels. Reuses the texture of `old` if it has the same size and is the window's own.
fn upload(gpu: &Gpu, size: UVec2, pixels: &[[u8; 4]], old: Option<&Bound>) -> wgpu::Texture {
    let extent = wgpu::Extent3d { width: size.x, height: size.y, depth_or_array_layers: 1 };
    let old = old.filter(|old| old.is_own && old.texture.size() == extent);
    let texture = old.map_or_else(|| new_texture(gpu, extent), |old| old.texture.clone());
    gpu.queue.write_texture(
        texture.as_image_copy(),
        pixels.as_flattened(),
        wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some(size.x * 4),
            rows_per_image: None,
        },
        extent,
    );
    texture
}

fn new_texture(gpu: &Gpu, size: wgpu::Extent3d) -> wgpu::Texture {
    gpu.device.create_texture(&wgpu::TextureDescriptor {
        label: Some("picture on the screen"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba8Unorm,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texture_in_use_is_not_reused() {
        let gpu = pollster::block_on(Gpu::new(&lumivox_render::GpuOptions::default())).unwrap();
        let size = |width| wgpu::Extent3d { width, height: 4, depth_or_array_layers: 1 };
        let mut screen = Screen::default();
        let drawn = screen.free_texture(&gpu, size(4));
        let published = screen.free_texture(&gpu, size(4));
        let written = screen.free_texture(&gpu, size(4));
        assert!(drawn != published && published != written && written != drawn);
        let was_drawn = (*drawn).clone();
        drop(drawn);
        assert_eq!(*screen.free_texture(&gpu, size(4)), was_drawn);
        assert_eq!(screen.textures.len(), 3, "a ring of three is enough");
        // Another size drops the textures of the old size.
        screen.free_texture(&gpu, size(8));
        assert_eq!(screen.textures.len(), 1);
        assert_eq!(published.size(), size(4), "who holds one keeps it");
    }
}
