//! The window's own device: what draws the panels and brings pictures from main memory to the screen.
//!
//! It is drawn on a canvas of which only what changes is painted anew, and which is copied to the screen.
//!
//! What egui has uploaded is remembered, so that another device can take its place when this one is lost.

use std::collections::HashMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use anyhow::Context as _;
use egui::epaint::textures::TexturesDelta;
use egui::epaint::{ImageData, ImageDelta};
use egui::{ClippedPrimitive, ColorImage, TextureId, TextureOptions};
use lumivox_console::Failure;
use wgpu::CurrentSurfaceTexture;
use winit::event_loop::OwnedDisplayHandle;
use winit::window::Window;

use super::damage;
use super::model::Shown;

/// Pictures on the screen: what is rendered, and what it is compared with.
pub const PICTURES: usize = 2;

/// Devices that are opened one after the other without a frame that is shown.
const MOST_REPLACEMENTS: u32 = 4;

/// A window's device and all that it draws with.
pub struct Surface {
    window: Arc<Window>,
    display: OwnedDisplayHandle,
    /// `None` while it is replaced: a window has one surface at a time.
    parts: Option<Parts>,
    /// Replacements since the last frame that was shown.
    replaced: u32,
    /// Whole images by their names.
    images: HashMap<TextureId, (ColorImage, TextureOptions)>,
    pictures: [Option<Arc<Shown>>; PICTURES],
}

/// What goes with the device.
struct Parts {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    device: wgpu::Device,
    queue: wgpu::Queue,
    painter: egui_wgpu::Renderer,
    shown: [Option<OnDevice>; PICTURES],
    /// The window as it was painted last; made with the first frame, and anew when the window's size changes.
    canvas: Option<Canvas>,
    /// Pictures that were written since the last frame.
    written: Vec<TextureId>,
    is_lost: Arc<AtomicBool>,
}

/// The window as it was painted last.
struct Canvas {
    texture: wgpu::Texture,
    painted: Vec<ClippedPrimitive>,
    pixels_per_point: f32,
}

/// A picture's texture.
struct OnDevice {
    texture: wgpu::Texture,
    id: TextureId,
    serial: u64,
}

impl Surface {
    /// Opens a device that can draw into the window.
    ///
    /// # Errors
    /// When there is none.
    pub fn new(window: Arc<Window>, display: OwnedDisplayHandle) -> anyhow::Result<Self> {
        let parts = Parts::new(&window, &display)?;
        Ok(Self {
            window,
            display,
            parts: Some(parts),
            replaced: 0,
            images: HashMap::new(),
            pictures: [None, None],
        })
    }

    /// The longest edge of a texture, px.
    pub fn max_texture_side(&self) -> usize {
        self.parts
            .as_ref()
            .map_or(2048, |parts| parts.device.limits().max_texture_dimension_2d as usize)
    }

    /// Follows the window's size.
    pub fn resize(&mut self, width: u32, height: u32) {
        let Some(parts) = &mut self.parts else { return };
        let most = parts.device.limits().max_texture_dimension_2d;
        let (width, height) = (width.min(most), height.min(most));
        if width > 0 && height > 0 && (parts.config.width, parts.config.height) != (width, height) {
            (parts.config.width, parts.config.height) = (width, height);
            parts.surface.configure(&parts.device, &parts.config);
        }
    }

    /// Shows another picture in a place; none keeps the place free.
    pub fn set_picture(&mut self, place: usize, picture: Option<Arc<Shown>>) -> Option<TextureId> {
        let kept = self.pictures.get_mut(place)?;
        *kept = picture;
        let picture = kept.as_ref()?;
        Some(self.parts.as_mut()?.upload(place, picture))
    }

    /// Loses the device, as a driver might.
    pub fn lose(&self) {
        if let Some(parts) = &self.parts {
            parts.device.destroy();
        }
    }

    /// Takes images that egui has made or changed. They count whether or not something is painted.
    fn take_images(&mut self, delta: &mut TexturesDelta) -> Vec<TextureId> {
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                self.remember(id, &delta);
                if let Some(Parts { painter, device, queue, .. }) = &mut self.parts {
                    painter.update_texture(device, queue, id, &delta);
                }
            }
        }
        delta.free.drain().collect()
    }

    fn remember(&mut self, id: TextureId, delta: &ImageDelta) {
        let ImageData::Color(part) = &delta.image;
        let Some([left, top]) = delta.pos else {
            self.images.insert(id, ((**part).clone(), delta.options));
            return;
        };
        let Some((image, _)) = self.images.get_mut(&id) else { return };
        let (width, part_width) = (image.size[0], part.size[0]);
        for (row, pixels) in part.pixels.chunks(part_width.max(1)).enumerate() {
            let start = (top + row) * width + left;
            if let Some(target) = image.pixels.get_mut(start..start + pixels.len()) {
                target.copy_from_slice(pixels);
            }
        }
    }

    /// Draws a frame of the window; a device or a surface that is lost is replaced. Nothing is drawn where the window has
    /// no size.
    ///
    /// # Errors
    /// When there is no other device.
    pub fn paint(
        &mut self,
        mut delta: TexturesDelta,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) -> anyhow::Result<()> {
        let is_lost = |parts: &Parts| parts.is_lost.load(Ordering::Relaxed);
        if self.parts.as_ref().is_none_or(is_lost) {
            self.replace()?;
            // What egui has drawn names textures of the device before.
            self.window.request_redraw();
        }
        let freed = self.take_images(&mut delta);
        let size = self.window.inner_size();
        if size.width > 0 && size.height > 0 {
            self.resize(size.width, size.height);
            self.draw(primitives, pixels_per_point)?;
        }
        for id in freed {
            self.images.remove(&id);
            if let Some(parts) = &mut self.parts {
                parts.painter.free_texture(&id);
            }
        }
        Ok(())
    }

    fn draw(
        &mut self,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) -> anyhow::Result<()> {
        let Some(parts) = &mut self.parts else { return Ok(()) };
        let Parts { surface, config, device, queue, painter, canvas, written, .. } = parts;
        let frame = match surface.get_current_texture() {
            CurrentSurfaceTexture::Success(frame) | CurrentSurfaceTexture::Suboptimal(frame) => {
                frame
            }
            CurrentSurfaceTexture::Outdated => {
                surface.configure(device, config);
                self.window.request_redraw();
                return Ok(());
            }
            CurrentSurfaceTexture::Lost | CurrentSurfaceTexture::Validation => {
                self.replace()?;
                self.window.request_redraw();
                return Ok(());
            }
            // It comes again when there is something to see.
            CurrentSurfaceTexture::Timeout | CurrentSurfaceTexture::Occluded => return Ok(()),
        };
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [config.width, config.height],
            pixels_per_point,
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let (canvas, parts) = Canvas::prepare(canvas, device, config, primitives, written, &screen);
        let changed: Vec<ClippedPrimitive> =
            parts.iter().flat_map(|part| damage::cut(primitives, *part)).collect();
        let mut commands = painter.update_buffers(device, queue, &mut encoder, &changed, &screen);
        if !changed.is_empty() {
            let view = canvas.texture.create_view(&wgpu::TextureViewDescriptor::default());
            let pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some("window"),
                color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                    view: &view,
                    depth_slice: None,
                    resolve_target: None,
                    ops: wgpu::Operations { load: wgpu::LoadOp::Load, store: wgpu::StoreOp::Store },
                })],
                ..Default::default()
            });
            painter.render(&mut pass.forget_lifetime(), &changed, &screen);
        }
        encoder.copy_texture_to_texture(
            canvas.texture.as_image_copy(),
            frame.texture.as_image_copy(),
            canvas.texture.size(),
        );
        commands.push(encoder.finish());
        queue.submit(commands);
        self.window.pre_present_notify();
        queue.present(frame);
        self.replaced = 0;
        Ok(())
    }

    /// Opens another device and uploads everything again.
    fn replace(&mut self) -> anyhow::Result<()> {
        self.replaced += 1;
        if self.replaced > MOST_REPLACEMENTS {
            return Err(Failure::display(
                "the window's GPU device was lost again and again; another driver may help",
            )
            .into());
        }
        tracing::warn!("the window's device was lost; going on with a new one");
        // First this: a window has one surface at a time.
        self.parts = None;
        let mut parts = Parts::new(&self.window, &self.display)?;
        for (id, (image, options)) in &self.images {
            let delta = ImageDelta::full(image.clone(), *options);
            parts.painter.update_texture(&parts.device, &parts.queue, *id, &delta);
        }
        for (place, picture) in self.pictures.iter().enumerate() {
            if let Some(picture) = picture {
                parts.upload(place, picture);
            }
        }
        self.parts = Some(parts);
        Ok(())
    }
}

impl Canvas {
    /// The canvas for a frame, and the parts of it that have to be painted.
    fn prepare<'a>(
        canvas: &'a mut Option<Self>,
        device: &wgpu::Device,
        config: &wgpu::SurfaceConfiguration,
        primitives: &[ClippedPrimitive],
        written: &mut Vec<TextureId>,
        screen: &egui_wgpu::ScreenDescriptor,
    ) -> (&'a Self, Vec<egui::Rect>) {
        let size =
            wgpu::Extent3d { width: config.width, height: config.height, depth_or_array_layers: 1 };
        let scale = screen.pixels_per_point;
        let fits = |canvas: &Self| {
            canvas.texture.size() == size && (canvas.pixels_per_point - scale).abs() < f32::EPSILON
        };
        let written = std::mem::take(written);
        let (texture, parts) = if let Some(canvas) = canvas.take().filter(fits) {
            let parts = damage::parts(&canvas.painted, primitives, &written);
            (canvas.texture, parts)
        } else {
            let texture = device.create_texture(&wgpu::TextureDescriptor {
                label: Some("window"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: config.format,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
                view_formats: &[],
            });
            let [width, height] = screen.size_in_pixels.map(|pixels| pixels as f32 / scale);
            let all = egui::Rect::from_min_size(egui::Pos2::ZERO, egui::vec2(width, height));
            (texture, vec![all])
        };
        let parts = parts.into_iter().map(|part| damage::on_pixels(part, scale)).collect();
        let painted = primitives.to_vec();
        (canvas.insert(Self { texture, painted, pixels_per_point: scale }), parts)
    }
}

impl Parts {
    fn new(window: &Arc<Window>, display: &OwnedDisplayHandle) -> anyhow::Result<Self> {
        let mut descriptor =
            wgpu::InstanceDescriptor::new_with_display_handle(Box::new(display.clone()));
        descriptor.backends = wgpu::Backends::VULKAN | wgpu::Backends::METAL | wgpu::Backends::DX12;
        let instance = wgpu::Instance::new(descriptor);
        let surface =
            instance.create_surface(window.clone()).context("the window cannot be drawn into")?;
        // Panels are no work: on a machine with two GPUs the thrifty one will do.
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::LowPower,
            compatible_surface: Some(&surface),
            ..Default::default()
        };
        let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|error| {
            Failure::display(format!(
                "no GPU adapter can draw into a window ({error}); install the GPU's driver, or a software driver that \
                 knows windows (on Debian and Ubuntu: mesa-vulkan-drivers)"
            ))
        })?;
        let limits = wgpu::Limits::default().using_resolution(adapter.limits());
        let request = wgpu::DeviceDescriptor {
            label: Some("window"),
            required_limits: limits,
            ..Default::default()
        };
        let (device, queue) = pollster::block_on(adapter.request_device(&request))?;
        let is_lost = Arc::new(AtomicBool::new(false));
        let lost = is_lost.clone();
        device.set_device_lost_callback(move |_, _| lost.store(true, Ordering::Relaxed));
        let lost = is_lost.clone();
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            tracing::debug!("the window's device: {error}");
            // What follows from a loss says so in many words; a window without a picture helps nobody.
            if matches!(error, wgpu::Error::OutOfMemory { .. } | wgpu::Error::Internal { .. }) {
                lost.store(true, Ordering::Relaxed);
            }
        }));
        let size = window.inner_size();
        let (width, height) = (size.width.max(1), size.height.max(1));
        let mut config = surface
            .get_default_config(&adapter, width, height)
            .context("the window cannot be drawn into by this GPU")?;
        // egui blends as screens show: without a conversion by the GPU.
        let formats = surface.get_capabilities(&adapter).formats;
        let is_plain = |format: &&wgpu::TextureFormat| {
            matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm)
        };
        if let Some(format) = formats.iter().find(is_plain) {
            config.format = *format;
        }
        config.usage |= wgpu::TextureUsages::COPY_DST;
        surface.configure(&device, &config);
        let painter =
            egui_wgpu::Renderer::new(&device, config.format, egui_wgpu::RendererOptions::default());
        Ok(Self {
            surface,
            config,
            device,
            queue,
            painter,
            shown: [None, None],
            canvas: None,
            written: Vec::new(),
            is_lost,
        })
    }

    /// The picture in its texture, which is made anew where the size changes.
    fn upload(&mut self, place: usize, picture: &Shown) -> TextureId {
        let size = wgpu::Extent3d {
            width: picture.size.x,
            height: picture.size.y,
            depth_or_array_layers: 1,
        };
        let old = self.shown[place].take();
        if let Some(shown) = old {
            if shown.texture.size() == size {
                let id = shown.id;
                if shown.serial != picture.serial {
                    self.write(&shown.texture, picture);
                    self.written.push(id);
                }
                self.shown[place] = Some(OnDevice { serial: picture.serial, ..shown });
                return id;
            }
            self.painter.free_texture(&shown.id);
        }
        let texture = self.device.create_texture(&wgpu::TextureDescriptor {
            label: Some("picture"),
            size,
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::Rgba8Unorm,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        self.write(&texture, picture);
        let view = texture.create_view(&wgpu::TextureViewDescriptor::default());
        let filter = wgpu::FilterMode::Linear;
        let id = self.painter.register_native_texture(&self.device, &view, filter);
        self.shown[place] = Some(OnDevice { texture, id, serial: picture.serial });
        id
    }

    fn write(&self, texture: &wgpu::Texture, picture: &Shown) {
        self.queue.write_texture(
            texture.as_image_copy(),
            picture.pixels.as_flattened(),
            wgpu::TexelCopyBufferLayout {
                offset: 0,
                bytes_per_row: Some(picture.size.x * 4),
                rows_per_image: None,
            },
            texture.size(),
        );
    }
}
