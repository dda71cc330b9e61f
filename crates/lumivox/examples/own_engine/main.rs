//! Lumivox in a custom engine: own window, triangles, G-buffer and shading, no other crate of the
//! project. A lamp circles in a room, and a screen slides through it.
//!
//! `cargo run --release -p lumivox --example own_engine` opens a window with the time of a frame in
//! its title.

mod engine;
mod raster;

use std::sync::Arc;
use std::time::Instant;

use engine::Engine;
use glam::UVec2;
use winit::application::ApplicationHandler;
use winit::event::WindowEvent;
use winit::event_loop::{ActiveEventLoop, EventLoop};
use winit::window::{Window, WindowId};

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut app = App { running: None, failure: None };
    EventLoop::new()?.run_app(&mut app)?;
    app.failure.map_or(Ok(()), Err)
}

/// The application, with its window once the event loop runs.
struct App {
    running: Option<Running>,
    failure: Option<Failure>,
}

struct Running {
    window: Arc<Window>,
    surface: wgpu::Surface<'static>,
    config: wgpu::SurfaceConfiguration,
    engine: Engine,
    start: Instant,
    /// When the window's title last showed the time of a frame, and the frames since.
    shown: (Instant, u32),
}

impl Running {
    async fn new(event_loop: &ActiveEventLoop) -> Result<Self, Failure> {
        let window = event_loop.create_window(Window::default_attributes())?;
        let window = Arc::new(window);
        let instance = wgpu::Instance::default();
        let surface = instance.create_surface(window.clone())?;
        let options = wgpu::RequestAdapterOptions {
            compatible_surface: Some(&surface),
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter = instance.request_adapter(&options).await?;
        // WebGPU's default limits are all that Lumivox needs.
        let (device, queue) = adapter.request_device(&wgpu::DeviceDescriptor::default()).await?;
        let size = UVec2::from(<[u32; 2]>::from(window.inner_size())).max(UVec2::ONE);
        let config = surface.get_default_config(&adapter, size.x, size.y);
        let mut config = config.ok_or("the adapter cannot show pictures in this window")?;
        config.format = config.format.add_srgb_suffix();
        surface.configure(&device, &config);
        let engine = Engine::new(device, queue, config.format, size)?;
        let start = Instant::now();
        Ok(Self { window, surface, config, engine, start, shown: (start, 0) })
    }

    fn resize(&mut self, [width, height]: [u32; 2]) {
        if width > 0 && height > 0 {
            (self.config.width, self.config.height) = (width, height);
            self.surface.configure(&self.engine.device, &self.config);
            self.engine.resize(UVec2::new(width, height));
        }
    }

    fn draw(&mut self) -> Result<(), Failure> {
        use wgpu::CurrentSurfaceTexture::{Suboptimal, Success};
        match self.surface.get_current_texture() {
            Success(target) | Suboptimal(target) => {
                let view = target.texture.create_view(&wgpu::TextureViewDescriptor::default());
                self.engine.frame(self.start.elapsed().as_secs_f32(), &view)?;
                self.engine.queue.present(target);
            }
            _ => self.surface.configure(&self.engine.device, &self.config),
        }
        self.shown.1 += 1;
        let seconds = self.shown.0.elapsed().as_secs_f64();
        if seconds > 1.0 {
            let ms = 1e3 * seconds / f64::from(self.shown.1);
            self.window.set_title(&format!("Lumivox in an own engine: {ms:.1} ms a frame"));
            self.shown = (Instant::now(), 0);
        }
        self.window.request_redraw();
        Ok(())
    }
}

impl ApplicationHandler for App {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        match pollster::block_on(Running::new(event_loop)) {
            Ok(running) => self.running = Some(running),
            Err(failure) => {
                self.failure = Some(failure);
                event_loop.exit();
            }
        }
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(running) = &mut self.running else { return };
        let drawn = match event {
            WindowEvent::CloseRequested => return event_loop.exit(),
            WindowEvent::Resized(size) => return running.resize(size.into()),
            WindowEvent::RedrawRequested => running.draw(),
            _ => return,
        };
        if let Err(failure) = drawn {
            self.failure = Some(failure);
            event_loop.exit();
        }
    }
}
