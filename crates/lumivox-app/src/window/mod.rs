//! The window: a thin front end on the console.
//!
//! Two threads. This one belongs to the window: it draws the panels by egui, and sends lines of the console's language to
//! the worker ([`worker`]), which owns the console and the explorer. Back come a snapshot for the panels ([`model`]) and
//! pictures ([`screen`]). A GPU draws the window with the device that renders, so that pictures stay where they are. Beside
//! a software driver the window has a device of its own, so that panels never wait for a frame.
//!
//! Whatever is done with the mouse is a line, which is written in the console: it can be read, repeated and put into a
//! script. Only the camera and the picture's size go as they are while they change.
//!
//! | file | is |
//! | --- | --- |
//! | `app.rs` | the window's state and its layout; `panels/`: what is in it |
//! | `events.rs` | the event loop |
//! | `surface.rs` | drawing the window |
//! | `screen.rs` | pictures on their way to the window |
//! | `orders.rs`, `outbox.rs` | what goes between the window and the worker |
//! | `worker/` | the thread that renders |
//! | `model.rs` | what the panels show |
//! | `keys.rs` | what keys do |
//! | `lines.rs` | lines on their way |
//! | `terminal.rs` | the terminal beside the window |
//! | `jobs.rs`, `reload.rs` | what runs beside: reading scenes, references, watching files |
//! | `camera.rs`, `gizmo.rs` | moving the camera, and objects |
//! | `config.rs` | what is kept between runs |
//! | `priority.rs` | the window goes before what it shows |

mod app;
mod camera;
mod config;
mod damage;
mod events;
mod gizmo;
mod jobs;
mod keys;
mod lines;
mod model;
mod orders;
mod outbox;
mod panels;
mod priority;
mod reload;
mod screen;
mod surface;
mod terminal;
mod theme;
mod worker;

use std::thread::JoinHandle;
use std::time::{Duration, Instant};

use lumivox_console::{Console, Failure, SceneRequest};
use winit::event_loop::EventLoop;

use crate::cli::WindowDevice;

pub use config::Config;
pub use events::{Wake, run};
pub use priority::give_way;
pub use terminal::Restore;

/// What the window starts with.
#[derive(Debug)]
pub struct Start {
    /// The console, with settings but without a scene.
    pub console: Console,
    /// The scene to open.
    pub opening: Option<SceneRequest>,
    /// How another device is opened if the first is lost.
    pub options: lumivox_render::GpuOptions,
    /// What was kept of the last time.
    pub config: Config,
    /// The device that the window is drawn with.
    pub device: WindowDevice,
}

/// Waits for the end of a thread, but not for ever; whether it has ended, and not by a panic.
fn join(thread: JoinHandle<()>, patience: Duration) -> Option<std::thread::Result<()>> {
    let start = Instant::now();
    while !thread.is_finished() {
        if start.elapsed() > patience {
            return None;
        }
        std::thread::sleep(Duration::from_millis(5));
    }
    Some(thread.join())
}

/// Connects to the display.
///
/// # Errors
/// When there is none, with what to do about it.
pub fn event_loop() -> anyhow::Result<EventLoop<Wake>> {
    // Without both variables winit's message speaks of its features.
    let built = EventLoop::<Wake>::with_user_event().build();
    built.map_err(|error| {
        Failure::display(format!(
            "there is no display for a window ({}); start it in a graphical session (on Linux $DISPLAY or \
             $WAYLAND_DISPLAY tells where), or use `lumivox render` for pictures and `lumivox run` for scripts, which \
             need none",
            error.to_string().trim_end_matches('.')
        ))
        .into()
    })
}
