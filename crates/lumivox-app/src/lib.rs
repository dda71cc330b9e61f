//! The `lumivox` program: voxel cone tracing on the command line and in a window.
//!
//! [`run`] reads a command line and runs its command; each command is a module. All output of a
//! command goes to stdout at its end, all messages to stderr. Both, and the GPU, come from a
//! [`Host`]: the program uses its process's; tests run many commands in one process, on one
//! device.
//!
//! # Features
//!
//! None is on by default. A build without features renders, compares, converts and runs scripts,
//! and has no window.
//!
//! | feature | adds |
//! | --- | --- |
//! | `prompt` | line editing, history and completion in `lumivox run`; without it, plain lines |
//! | `window` | `lumivox view`; and `prompt`, for the terminal beside the window |
//!
//! Each feature is checked in one place: `commands/mod.rs` (`view`), here (`prompt`, `window`).

#![allow(
    clippy::format_push_string,
    reason = "write! into a String returns an error that cannot happen"
)]
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]
#![cfg_attr(
    not(feature = "window"),
    allow(dead_code, unused_imports, reason = "some shared code serves the window alone")
)]

mod args;
mod cli;
mod commands;
mod disk;
mod exit;
mod host;
mod light;
mod lock;
mod log;
mod opening;
pub mod parts;
mod program;
mod progress;
#[cfg(feature = "prompt")]
mod prompt;
#[cfg(not(feature = "prompt"))]
#[path = "prompt/plain.rs"]
mod prompt;
mod quality;
mod sequence;
mod settings;
mod timeline;
#[cfg(feature = "window")]
mod window;

use std::ffi::OsString;

pub use exit::{Exit, guard, of_error as exit_of};
pub use host::{Embedded, Host, OpenGpu};
pub use program::main;
pub use quality::{FalseColor, false_color_png};

/// Runs a command line; its first word is the program's name.
pub fn run(args: impl IntoIterator<Item = OsString>, host: &Host) -> Exit {
    program::run::<cli::Cli>(args, host)
}
