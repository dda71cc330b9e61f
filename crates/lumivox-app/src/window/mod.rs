//! The window: a thin front end on the console.
//!
//! The main thread owns the window: it draws the panels with egui, and sends lines of the console's
//! language to the worker thread ([`worker`]), which owns the console and the explorer. The worker
//! sends back a snapshot for the panels ([`model`]) and pictures ([`screen`]). With a GPU, the
//! window uses the worker's device, so that pictures stay on it. With a software driver, the window
//! has its own device, so that panels never wait for a frame.
//!
//! Every mouse action is a line, shown in the console: it can be read, repeated and put into a
//! script. Only the camera and the picture's size are sent as values; the camera's line is logged.
//!
//! | file | is |
//! | --- | --- |
//! | `app.rs`, `panels/` | the window's state and layout; its panels |
//! | `events.rs` | the event loop |
//! | `surface.rs` | drawing the window |
//! | `screen.rs` | sending pictures to the window |
//! | `orders.rs`, `outbox.rs` | communication between the window and the worker |
//! | `worker/` | the thread that renders |
//! | `model.rs` | the snapshot for the panels |
//! | `keys.rs` | keyboard shortcuts |
//! | `selection.rs` | the selected object or light, and the camera around it |
//! | `lines.rs` | lines to be run by the console |
//! | `terminal.rs` | the terminal beside the window |
//! | `jobs.rs`, `reload.rs` | background jobs: reading scenes, references, watching files |
//! | `camera.rs`, `gizmo.rs` | moving the camera, and objects |
//! | `config.rs` | state that is saved between runs |
//! | `priority.rs` | the worker's lower priority |

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
mod selection;
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

/// The window's initial state.
#[derive(Debug)]
pub struct Start {
    /// The console, with settings but without a scene.
    pub console: Console,
    /// The scene to open.
    pub opening: Option<SceneRequest>,
    /// Options for opening another device if the first is lost.
    pub options: lumivox_render::GpuOptions,
    /// The saved state.
    pub config: Config,
    /// The device that the window is drawn with.
    pub device: WindowDevice,
}

/// Waits for a thread to end; `None` if it takes longer than `patience`.
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
/// When there is no display; the message says what to do.
pub fn event_loop() -> anyhow::Result<EventLoop<Wake>> {
    // Replace winit's message: without both variables it is about winit's features.
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
