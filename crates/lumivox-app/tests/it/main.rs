//! The program as users see it: on the command line, in scripts, in its window.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "in a test a panic is the message, and zero is exact"
)]

mod animations;
mod bad_input;
mod bake;
mod bench;
mod cli;
mod common;
mod compare;
mod console;
mod hostile;
mod measure;
mod merge;
mod process;
mod reference;
mod scene_files;
mod sequences;
mod truth;
mod volumes;
#[cfg(all(feature = "window", target_os = "linux"))]
mod window;

use lumivox_app::run;

/// The tested program.
const PROGRAM: &str = env!("CARGO_BIN_EXE_lumivox");
