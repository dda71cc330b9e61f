//! The event loop: input to egui, egui to the screen.

use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use anyhow::Context as _;
use egui::ViewportId;
use egui_winit::accesskit_winit;
use lumivox_console::Failure;
use winit::application::ApplicationHandler;
use winit::dpi::LogicalSize;
use winit::event::{StartCause, WindowEvent};
use winit::event_loop::{ActiveEventLoop, ControlFlow, EventLoop};
use winit::window::{Fullscreen, Window, WindowId};

use super::app::App;
use super::orders::{Order, WindowRequest};
use super::surface::Surface;
use super::{Start, theme, worker};
use crate::cli::WindowDevice;

/// Events that wake the window.
#[derive(Debug)]
pub enum Wake {
    /// The worker has published something.
    Published,
    /// A screen reader has sent a request.
    Access(accesskit_winit::Event),
}

impl From<accesskit_winit::Event> for Wake {
    fn from(event: accesskit_winit::Event) -> Self {
        Self::Access(event)
    }
}

/// The least size of the window, points.
const LEAST: LogicalSize<f64> = LogicalSize::new(480.0, 320.0);

/// Maximum wait for the current frame or command when the window is closed.
const PATIENCE: Duration = Duration::from_secs(20);

/// Shows the window until it is closed.
///
/// # Errors
/// When no window can be created, or no device can draw into it.
pub fn run(event_loop: EventLoop<Wake>, start: Start) -> anyhow::Result<()> {
    let proxy = Mutex::new(event_loop.create_proxy());
    let wake = move || {
        if let Ok(proxy) = proxy.lock() {
            // The window may be closed already.
            let _ = proxy.send_event(Wake::Published);
        }
    };
    let Start { console, opening, options, config, device } = start;
    let (orders, shared, thread) = worker::start(console, options, opening, wake);
    let context = egui::Context::default();
    theme::apply(&context);
    let app = App::new(config, orders, shared);
    let mut handler = Handler {
        proxy: event_loop.create_proxy(),
        context,
        app,
        device,
        open: None,
        next_paint: None,
        error: None,
    };
    event_loop.run_app(&mut handler)?;
    handler.app.outbox.order(Order::Quit);
    // Close the window before waiting for the worker.
    handler.open = None;
    let ended = super::join(thread, PATIENCE);
    handler.app.save();
    if let Some(error) = handler.error {
        return Err(error);
    }
    match ended {
        Some(Ok(())) => Ok(()),
        Some(Err(_)) => Err(anyhow::anyhow!(
            "the thread that renders has failed, which is a mistake in Lumivox; what it said is above"
        )),
        None => {
            tracing::warn!("the last command or frame was not waited for: it takes too long");
            Ok(())
        }
    }
}

struct Handler {
    proxy: winit::event_loop::EventLoopProxy<Wake>,
    context: egui::Context,
    app: App,
    device: WindowDevice,
    open: Option<Open>,
    /// When to repaint, as egui has requested.
    next_paint: Option<Instant>,
    error: Option<anyhow::Error>,
}

/// A window on the screen.
struct Open {
    window: Arc<Window>,
    input: egui_winit::State,
    surface: Surface,
}

impl Handler {
    fn fail(&mut self, event_loop: &ActiveEventLoop, error: anyhow::Error) {
        self.error = Some(error);
        event_loop.exit();
    }

    fn open(&mut self, event_loop: &ActiveEventLoop) -> anyhow::Result<Open> {
        let [width, height] = self.app.config.window;
        let attributes = Window::default_attributes()
            .with_title("Lumivox")
            .with_inner_size(LogicalSize::new(width, height))
            .with_min_inner_size(LEAST)
            // AccessKit must be initialized before the window is visible.
            .with_visible(false);
        let window = event_loop
            .create_window(attributes)
            .map_err(|error| Failure::display(format!("the display refuses a window: {error}")))?;
        let window = Arc::new(window);
        let mut input = egui_winit::State::new(
            self.context.clone(),
            ViewportId::ROOT,
            &window,
            Some(window.scale_factor() as f32),
            window.theme(),
            None,
        );
        input.init_accesskit(event_loop, &window, self.proxy.clone());
        let worker = self.app.look().gpu.context("the worker has published no device")?;
        let surface = Surface::new(window.clone(), worker, self.device)?;
        input.set_max_texture_side(surface.max_texture_side());
        window.set_visible(true);
        Ok(Open { window, input, surface })
    }

    fn paint(&mut self, event_loop: &ActiveEventLoop) {
        let Some(Open { window, input, surface }) = &mut self.open else { return };
        let published = self.app.look();
        match published.request {
            Some(WindowRequest::LoseDevice) => surface.lose(),
            Some(WindowRequest::FullScreen) => {
                let is_full = window.fullscreen().is_some();
                window.set_fullscreen((!is_full).then_some(Fullscreen::Borderless(None)));
            }
            None => {}
        }
        if published.has_ended {
            event_loop.exit();
            return;
        }
        if let Some(error) = published.gpu.and_then(|worker| surface.follow(worker).err()) {
            self.fail(event_loop, error);
            return;
        }
        if let Some(device) = surface.device() {
            self.app.outbox.set_device(device);
        }
        self.app.picture.textures = [
            surface.set_picture(0, published.picture.clone()),
            surface.set_picture(1, published.other.clone()),
        ];
        let app = &mut self.app;
        let output = self.context.run_ui(input.take_egui_input(window), |ui| app.show(ui));
        input.handle_platform_output_with_event_loop(window, event_loop, output.platform_output);
        let mut is_closing = false;
        for viewport in output.viewport_output.values() {
            is_closing |= viewport.commands.contains(&egui::ViewportCommand::Close);
            self.next_paint = Instant::now().checked_add(viewport.repaint_delay);
            if viewport.repaint_delay.is_zero() {
                window.request_redraw();
            }
        }
        let scale = output.pixels_per_point;
        let primitives = self.context.tessellate(output.shapes, scale);
        let size = window.inner_size().to_logical::<f32>(window.scale_factor());
        if size.width > 0.0 && size.height > 0.0 && window.fullscreen().is_none() {
            self.app.config.window = [size.width, size.height];
        }
        if let Err(error) = surface.paint(output.textures_delta, &primitives, scale) {
            self.fail(event_loop, error);
            return;
        }
        self.app.outbox.set_shown(surface.shown());
        if is_closing {
            event_loop.exit();
        }
    }
}

impl ApplicationHandler<Wake> for Handler {
    fn resumed(&mut self, event_loop: &ActiveEventLoop) {
        if self.open.is_none() {
            match self.open(event_loop) {
                Ok(open) => self.open = Some(open),
                Err(error) => return self.fail(event_loop, error),
            }
        }
        if let Some(open) = &self.open {
            open.window.request_redraw();
        }
    }

    fn new_events(&mut self, _: &ActiveEventLoop, cause: StartCause) {
        if let (StartCause::ResumeTimeReached { .. }, Some(open)) = (cause, &self.open) {
            self.next_paint = None;
            open.window.request_redraw();
        }
    }

    fn user_event(&mut self, event_loop: &ActiveEventLoop, wake: Wake) {
        let Some(open) = &mut self.open else { return };
        match wake {
            Wake::Published => {
                // A minimized window gets no redraws, so check for the worker's end here.
                if self.app.outbox.has_ended() {
                    event_loop.exit();
                }
            }
            Wake::Access(event) => match event.window_event {
                accesskit_winit::WindowEvent::InitialTreeRequested => {
                    self.context.enable_accesskit();
                }
                accesskit_winit::WindowEvent::ActionRequested(request) => {
                    open.input.on_accesskit_action_request(request);
                }
                accesskit_winit::WindowEvent::AccessibilityDeactivated => {
                    self.context.disable_accesskit();
                }
            },
        }
        open.window.request_redraw();
    }

    fn window_event(&mut self, event_loop: &ActiveEventLoop, _: WindowId, event: WindowEvent) {
        let Some(open) = &mut self.open else { return };
        let response = open.input.on_window_event(&open.window, &event);
        match event {
            WindowEvent::CloseRequested => event_loop.exit(),
            WindowEvent::RedrawRequested => self.paint(event_loop),
            WindowEvent::Resized(_) => open.window.request_redraw(),
            WindowEvent::DroppedFile(file) => {
                self.app.outbox.open(&file.display().to_string());
                open.window.request_redraw();
            }
            _ if response.repaint => open.window.request_redraw(),
            _ => {}
        }
    }

    fn about_to_wait(&mut self, event_loop: &ActiveEventLoop) {
        event_loop.set_control_flow(match self.next_paint {
            Some(at) => ControlFlow::WaitUntil(at),
            None => ControlFlow::Wait,
        });
    }
}
