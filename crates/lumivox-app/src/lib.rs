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

use clap::{CommandFactory as _, Parser as _};
use lumivox_console::shown;

use cli::{Cli, Command};
pub use exit::{Exit, guard, of_error as exit_of};
pub use host::{Embedded, Host, OpenGpu};
pub use quality::{FalseColor, false_color_png};

/// Runs a command line; its first word is the program's name.
pub fn run(args: impl IntoIterator<Item = OsString>, host: &Host) -> Exit {
    let args: Vec<OsString> = args.into_iter().collect();
    let cli = match Cli::try_parse_from(&args) {
        Ok(cli) => cli,
        Err(error) => {
            // File names that a shell filled in may contain control characters, and messages repeat
            // them: escape them.
            let shown = args.iter().map(|arg| shown::line(&arg.to_string_lossy()).into_owned());
            let error = Cli::try_parse_from(shown).err().unwrap_or(error);
            return host.report_usage(&error);
        }
    };
    let tells_warnings = matches!(cli.command, Some(Command::Info(_)));
    let _log = log::start(cli.verbose, tells_warnings, host);
    let done = match &cli.command {
        None => host.print(&format!("{}\n", Cli::command().render_help())),
        Some(Command::Render(args)) => commands::render::run(args, cli.verbose, host),
        Some(Command::View(args)) => commands::view::run(args, host),
        Some(Command::Reference(args)) => commands::reference::run(args, host),
        Some(Command::Merge(args)) => commands::merge::run(args, host),
        Some(Command::Quality(args)) => commands::quality::run(args, host),
        Some(Command::Rooms(args)) => commands::rooms::run(args, host),
        Some(Command::Measure(args)) => commands::measure::run(args, host),
        Some(Command::Bake(args)) => commands::bake::run(args, host),
        Some(Command::Motion(args)) => commands::motion::run(args, host),
        Some(Command::Info(args)) => commands::info::run(args, host),
        Some(Command::Volumes(args)) => commands::volumes::run(args, host),
        Some(Command::Voxels(args)) => commands::voxels::run(args, host),
        Some(Command::Bench(args)) => commands::bench::run(args, host),
        Some(Command::Convert(args)) => commands::convert::run(args, host),
        Some(Command::Compare(args)) => commands::compare::run(args, host),
        Some(Command::Run(args)) => commands::run::run(args, host),
        Some(Command::Commands(args)) => commands::run::list(args.markdown, host),
        Some(Command::Scenes) => commands::scenes::run(host),
    };
    match done {
        Ok(()) => Exit::Ok,
        Err(error) => host.report(&error),
    }
}
