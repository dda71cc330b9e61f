//! Drawing the window: the panels and the pictures, with the worker's device or its own.
//!
//! The window is drawn on a canvas, which is copied to the screen; only changed parts are
//! repainted.
//!
//! Copies of egui's images are kept, so that a lost device can be replaced. If the worker's device
//! is lost, the window draws with its own until the worker publishes another.

use std::collections::HashMap;
use std::sync::Arc;

use anyhow::Context as _;
use egui::epaint::textures::TexturesDelta;
use egui::epaint::{ImageData, ImageDelta};
use egui::{ClippedPrimitive, ColorImage, TextureId, TextureOptions};
use lumivox_console::Failure;
use lumivox_render::{Gpu, GpuId};
use wgpu::CurrentSurfaceTexture;
use winit::window::Window;

use super::damage;
use super::screen::{PICTURES, Shown, Textures};
use crate::cli::WindowDevice;

/// Maximum replacements of the device without showing a frame in between.
const MOST_REPLACEMENTS: u32 = 4;

/// A window and its drawing state.
pub struct Surface {
    window: Arc<Window>,
    /// The device that renders.
    worker: Gpu,
    /// The device that the user has requested.
    asked: WindowDevice,
    /// State of the device; `None` while it is replaced, since a window has one surface at a time.
    parts: Option<Parts>,
    /// Replacements since the last frame that was shown.
    replaced: u32,
    /// The number of the newest picture in the last frame that was shown.
    shown: u64,
    /// egui's whole images, by id.
    images: HashMap<TextureId, (ColorImage, TextureOptions)>,
    pictures: [Option<Arc<Shown>>; PICTURES],
}

/// State that belongs to the device.
struct Parts {
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    gpu: Gpu,
    painter: egui_wgpu::Renderer,
    textures: Textures,
    /// The painted window; replaced when its size or scale changes. `None` before the first frame.
    canvas: Option<Canvas>,
    /// `true` if the device is out of memory or its driver has failed.
    is_broken: bool,
}

/// The window as last painted.
struct Canvas {
    texture: wgpu::Texture,
    painted: Vec<ClippedPrimitive>,
    pixels_per_point: f32,
}

/// The result of an attempt to draw.
enum Drawn {
    Shown,
    /// The window is not visible.
    NotNow,
    /// The surface has changed or is busy; draw again.
    Again,
    /// The surface or its device is gone.
    Lost,
}

impl Surface {
    /// Opens a device that can draw into the window.
    ///
    /// # Errors
    /// When there is no such device.
    pub fn new(window: Arc<Window>, worker: Gpu, asked: WindowDevice) -> anyhow::Result<Self> {
        let (images, pictures) = (HashMap::new(), [None, None]);
        let mut surface =
            Self { window, worker, asked, parts: None, replaced: 0, shown: 0, images, pictures };
        surface.open(surface.shares())?;
        Ok(surface)
    }

    /// The device that draws the window.
    pub fn device(&self) -> Option<GpuId> {
        self.parts.as_ref().map(|parts| parts.gpu.id)
    }

    /// The longest edge of a texture, px.
    pub fn max_texture_side(&self) -> usize {
        let most = |parts: &Parts| parts.gpu.device.limits().max_texture_dimension_2d as usize;
        self.parts.as_ref().map_or(2048, most)
    }

    /// Notes the worker's device, and switches to it if the window shares it.
    ///
    /// # Errors
    /// When no device can draw into the window.
    pub fn follow(&mut self, worker: Gpu) -> anyhow::Result<()> {
        if worker.id == self.worker.id {
            return Ok(());
        }
        self.worker = worker;
        if self.shares() { self.open(true) } else { Ok(()) }
    }

    /// Sets or removes the picture in a place. Returns its id in egui; `None` if it belongs to
    /// another device, in which case the worker will publish another.
    pub fn set_picture(&mut self, place: usize, picture: Option<Arc<Shown>>) -> Option<TextureId> {
        let kept = self.pictures.get_mut(place)?;
        *kept = picture;
        let picture = kept.as_ref()?;
        self.parts.as_mut()?.guarded(|parts| parts.bind(place, picture))
    }

    /// The number of the newest picture that is on the screen; 0 before there is one.
    pub fn shown(&self) -> u64 {
        self.shown
    }

    /// Destroys the device, to test its loss.
    pub fn lose(&self) {
        if let Some(parts) = &self.parts {
            parts.gpu.device.destroy();
        }
    }

    /// Whether the worker's device is to draw the window.
    fn shares(&self) -> bool {
        match self.asked {
            WindowDevice::Auto => !self.worker.is_software(),
            WindowDevice::Shared => true,
            WindowDevice::Own => false,
        }
    }

    /// Applies egui's new and changed images, even if nothing is painted; returns the freed ones.
    fn take_images(&mut self, delta: &mut TexturesDelta) -> Vec<TextureId> {
        for (id, deltas) in delta.set.drain() {
            for delta in deltas {
                self.remember(id, &delta);
                if let Some(parts) = &mut self.parts {
                    parts.guarded(|parts| parts.upload(id, &delta));
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

    /// Draws a frame of the window, unless its size is zero; replaces a lost device or surface.
    ///
    /// # Errors
    /// When there is no other device.
    pub fn paint(
        &mut self,
        mut delta: TexturesDelta,
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) -> anyhow::Result<()> {
        if self.parts.as_ref().is_none_or(Parts::is_lost) {
            self.replace()?;
            // This frame's shapes refer to textures of the lost device: draw another.
            self.window.request_redraw();
        }
        let freed = self.take_images(&mut delta);
        let size = self.window.inner_size();
        if size.width > 0 && size.height > 0 {
            self.draw([size.width, size.height], primitives, pixels_per_point)?;
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
        size: [u32; 2],
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) -> anyhow::Result<()> {
        let Some(parts) = &mut self.parts else { return Ok(()) };
        let window = &self.window;
        match parts.guarded(|parts| parts.draw(window, size, primitives, pixels_per_point)) {
            Drawn::Shown => {
                self.shown = parts.textures.newest();
                self.replaced = 0;
            }
            Drawn::NotNow => {}
            Drawn::Again => self.window.request_redraw(),
            Drawn::Lost => {
                self.replace()?;
                self.window.request_redraw();
            }
        }
        Ok(())
    }

    /// Reopens everything after a loss.
    fn replace(&mut self) -> anyhow::Result<()> {
        self.replaced += 1;
        if self.replaced > MOST_REPLACEMENTS {
            return Err(Failure::display(
                "the window's GPU device was lost again and again; another driver may help",
            )
            .into());
        }
        tracing::warn!("the window's device was lost; going on with a new one");
        // Do not share the worker's device: it may be lost, which wgpu reports only after a
        // failure, and egui panics on a lost device. The worker replaces it itself.
        self.open(false)
    }

    /// Opens a surface, with the worker's device if `shares` and it can draw into the window, and
    /// uploads everything to it.
    fn open(&mut self, shares: bool) -> anyhow::Result<()> {
        // Drop the old surface first: a window has one at a time.
        self.parts = None;
        let mut parts = Parts::new(&self.window, &self.worker, shares)?;
        parts.guarded(|parts| {
            for (id, (image, options)) in &self.images {
                parts.upload(*id, &ImageDelta::full(image.clone(), *options));
            }
            for (place, picture) in self.pictures.iter().enumerate() {
                if let Some(picture) = picture {
                    parts.bind(place, picture);
                }
            }
        });
        self.parts = Some(parts);
        Ok(())
    }
}

impl Canvas {
    /// The canvas for a frame, and its parts that must be painted.
    fn prepare<'a>(
        canvas: &'a mut Option<Self>,
        device: &wgpu::Device,
        config: &wgpu::SurfaceConfiguration,
        primitives: &[ClippedPrimitive],
        written: &[TextureId],
        screen: &egui_wgpu::ScreenDescriptor,
    ) -> (&'a Self, Vec<egui::Rect>) {
        let size =
            wgpu::Extent3d { width: config.width, height: config.height, depth_or_array_layers: 1 };
        let scale = screen.pixels_per_point;
        let fits = |canvas: &Self| {
            canvas.texture.size() == size && (canvas.pixels_per_point - scale).abs() < f32::EPSILON
        };
        let (texture, parts) = if let Some(canvas) = canvas.take().filter(fits) {
            let parts = damage::parts(&canvas.painted, primitives, written);
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
    fn new(window: &Arc<Window>, worker: &Gpu, shares: bool) -> anyhow::Result<Self> {
        let surface = worker.instance.create_surface(window.clone());
        let surface = surface.context("the window cannot be drawn into")?;
        let fits = shares && !worker.is_lost() && worker.adapter.is_surface_supported(&surface);
        let gpu = if fits { worker.clone() } else { own_device(&worker.instance, &surface)? };
        let size = window.inner_size();
        let (width, height) = (size.width.max(1), size.height.max(1));
        let mut config = surface
            .get_default_config(&gpu.adapter, width, height)
            .context("the window cannot be drawn into by this GPU")?;
        // egui blends in gamma space, so use a format without sRGB conversion.
        let formats = surface.get_capabilities(&gpu.adapter).formats;
        let is_plain = |format: &&wgpu::TextureFormat| {
            matches!(format, wgpu::TextureFormat::Bgra8Unorm | wgpu::TextureFormat::Rgba8Unorm)
        };
        if let Some(format) = formats.iter().find(is_plain) {
            config.format = *format;
        }
        config.usage |= wgpu::TextureUsages::COPY_DST;
        let (painter, is_broken) = guarded(&gpu.device, || {
            surface.configure(&gpu.device, &config);
            let options = egui_wgpu::RendererOptions::default();
            egui_wgpu::Renderer::new(&gpu.device, config.format, options)
        });
        let textures = Textures::default();
        Ok(Self { surface, config, gpu, painter, textures, canvas: None, is_broken })
    }

    fn is_lost(&self) -> bool {
        self.is_broken || self.gpu.is_lost()
    }

    /// Calls the device. Treats out-of-memory errors and driver failures as its loss.
    fn guarded<T>(&mut self, call: impl FnOnce(&mut Self) -> T) -> T {
        let device = self.gpu.device.clone();
        let (done, is_broken) = guarded(&device, || call(self));
        self.is_broken |= is_broken;
        done
    }

    fn upload(&mut self, id: TextureId, delta: &ImageDelta) {
        self.painter.update_texture(&self.gpu.device, &self.gpu.queue, id, delta);
    }

    fn bind(&mut self, place: usize, picture: &Shown) -> Option<TextureId> {
        self.textures.bind(place, picture, &self.gpu, &mut self.painter)
    }

    /// Resizes the surface to the window's size, px. Returns `false` if the device refuses, for
    /// example while the worker submits; the surface then keeps its size.
    fn resize(&mut self, size: [u32; 2]) -> bool {
        let device = &self.gpu.device;
        let most = device.limits().max_texture_dimension_2d;
        let [width, height] = size.map(|edge| edge.min(most));
        if (self.config.width, self.config.height) == (width, height) {
            return true;
        }
        let scope = device.push_error_scope(wgpu::ErrorFilter::Validation);
        let config = wgpu::SurfaceConfiguration { width, height, ..self.config.clone() };
        self.surface.configure(device, &config);
        let is_resized = pollster::block_on(scope.pop()).is_none();
        if is_resized {
            self.config = config;
        }
        is_resized
    }

    /// Draws a frame of the window.
    fn draw(
        &mut self,
        window: &Window,
        size: [u32; 2],
        primitives: &[ClippedPrimitive],
        pixels_per_point: f32,
    ) -> Drawn {
        if !self.resize(size) {
            return Drawn::Again;
        }
        let Self { surface, config, gpu, painter, textures, canvas, .. } = self;
        let (device, queue) = (&gpu.device, &gpu.queue);
        let frame = match surface.get_current_texture() {
            CurrentSurfaceTexture::Success(frame) | CurrentSurfaceTexture::Suboptimal(frame) => {
                frame
            }
            CurrentSurfaceTexture::Outdated => {
                surface.configure(device, config);
                return Drawn::Again;
            }
            CurrentSurfaceTexture::Lost | CurrentSurfaceTexture::Validation => return Drawn::Lost,
            // On a shared device, a long frame of the worker may be in progress.
            CurrentSurfaceTexture::Timeout => return Drawn::Again,
            // A redraw follows once the window is visible.
            CurrentSurfaceTexture::Occluded => return Drawn::NotNow,
        };
        let screen = egui_wgpu::ScreenDescriptor {
            size_in_pixels: [config.width, config.height],
            pixels_per_point,
        };
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        let changed = textures.take_changed();
        let (canvas, parts) =
            Canvas::prepare(canvas, device, config, primitives, &changed, &screen);
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
        window.pre_present_notify();
        queue.present(frame);
        Drawn::Shown
    }
}

/// Opens a device for the window only.
fn own_device(instance: &wgpu::Instance, surface: &wgpu::Surface<'_>) -> anyhow::Result<Gpu> {
    // Panels are little work: prefer the low-power GPU.
    let options = wgpu::RequestAdapterOptions {
        power_preference: wgpu::PowerPreference::LowPower,
        compatible_surface: Some(surface),
        ..Default::default()
    };
    let adapter = pollster::block_on(instance.request_adapter(&options)).map_err(|error| {
        Failure::display(format!(
            "no GPU adapter can draw into a window ({error}); install the GPU's driver, or a software driver that \
             knows windows (on Debian and Ubuntu: mesa-vulkan-drivers)"
        ))
    })?;
    let request = wgpu::DeviceDescriptor {
        label: Some("window"),
        required_limits: wgpu::Limits::default().using_resolution(adapter.limits()),
        ..Default::default()
    };
    let (device, queue) = pollster::block_on(adapter.request_device(&request))?;
    Ok(Gpu::with_device(instance.clone(), adapter, device, queue))
}

/// Calls a device in error scopes, since the worker may share it. Also returns whether it ran out
/// of memory or the driver failed.
fn guarded<T>(device: &wgpu::Device, call: impl FnOnce() -> T) -> (T, bool) {
    use wgpu::ErrorFilter::{Internal, OutOfMemory, Validation};
    let scopes = [Validation, OutOfMemory, Internal].map(|filter| device.push_error_scope(filter));
    let done = call();
    let mut is_broken = false;
    for scope in scopes.into_iter().rev() {
        if let Some(error) = pollster::block_on(scope.pop()) {
            // Only for debugging: errors after a loss are verbose.
            tracing::debug!("the window's device: {error}");
            is_broken |= !matches!(error, wgpu::Error::Validation { .. });
        }
    }
    (done, is_broken)
}
