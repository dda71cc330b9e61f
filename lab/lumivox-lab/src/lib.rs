//! The `lumivox-lab` program: Lumivox measures itself. It is for developers, and is not shipped.
//!
//! | module | is |
//! | --- | --- |
//! | `quality` | docs/generated/quality.md: errors of built-in scenes, of rooms at random, of materials |
//! | `rooms` | errors of light in rooms at random |
//! | `motion` | docs/generated/motion.md: errors, flicker, delay and cost while something moves |
//! | `volumes` | memory and times of dense and octree volumes |
//! | `voxelizers` | all voxelizers against the exact one |
//! | `dynamic` | the gain of keeping the static surface while other things move |
//! | `kernels` | docs/generated/kernels.md: registers and waves of every kernel on AMD's GPUs |
//! | `charts`, `film`, `block_noise` | charts as SVG, animated pictures, the noise of a picture |
//!
//! Pictures are measured as by `lumivox compare` ([`lumivox_app::parts`]).

#![allow(
    clippy::format_push_string,
    reason = "write! into a String returns an error that cannot happen"
)]
#![cfg_attr(
    test,
    allow(clippy::unwrap_used, clippy::float_cmp, reason = "in a test a panic is the message")
)]

mod block_noise;
mod charts;
mod cli;
mod dynamic;
mod film;
mod kernels;
mod motion;
mod quality;
mod rooms;
mod volumes;
mod voxelizers;

use std::ffi::OsString;

use lumivox_app::{Exit, Host};
use lumivox_render::{Gpu, describe};

/// Runs a command line; its first word is the program's name.
pub fn run(args: impl IntoIterator<Item = OsString>, host: &Host) -> Exit {
    lumivox_app::parts::run::<cli::Cli>(args, host)
}

/// The machine, as pages name it.
fn machine(gpu: &Gpu) -> String {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    format!("{}, {cores} cores", describe(&gpu.adapter_info))
}
