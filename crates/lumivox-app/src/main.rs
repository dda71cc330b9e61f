//! The `lumivox` program: voxel cone tracing on the command line and in a window.
//!
//! `main` reads the command line and starts the log; each command is a module of its own. All
//! output of a command goes to stdout at its end, all messages to stderr.

#![allow(
    clippy::format_push_string,
    reason = "write! into a String returns an error that cannot happen"
)]
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]

mod args;
mod cli;
mod commands;
mod console;
mod exit;
mod log;
mod motion;
mod opening;
mod progress;
mod quality;
mod report;
mod sequence;
mod window;

use std::process::ExitCode;

use clap::{CommandFactory as _, Parser as _};
use indicatif::MultiProgress;

use cli::{Cli, Command};
use exit::Exit;

fn main() -> ExitCode {
    let exit = exit::guard(run);
    console::terminal::restore();
    exit.into()
}

fn run() -> Exit {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(error) => return exit::with_clap(&error),
    };
    let bars = MultiProgress::new();
    let tells_warnings = matches!(cli.command, Some(Command::Info(_)));
    log::start(cli.verbose, tells_warnings, &bars);
    let done = match &cli.command {
        None => report::print(&format!("{}\n", Cli::command().render_help())),
        Some(Command::Render(args)) => commands::render::run(args, cli.verbose, &bars),
        Some(Command::View(args)) => commands::view::run(args, &bars),
        Some(Command::Reference(args)) => commands::reference::run(args, &bars),
        Some(Command::Quality(args)) => commands::quality::run(args, &bars),
        Some(Command::Info(args)) => commands::info::run(args, &bars),
        Some(Command::Volumes(args)) => commands::volumes::run(args, &bars),
        Some(Command::Voxels(args)) => commands::voxels::run(args, &bars),
        Some(Command::Convert(args)) => commands::convert::run(args, &bars),
        Some(Command::Compare(args)) => commands::compare::run(args, &bars),
        Some(Command::Run(args)) => commands::run::run(args, &bars),
        Some(Command::Commands(args)) => commands::run::list(args.markdown),
        Some(Command::Scenes) => commands::scenes::run(),
    };
    match done {
        Ok(()) => Exit::Ok,
        Err(error) => exit::with_error(&error),
    }
}
