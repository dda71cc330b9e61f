//! The laboratory as users see it.

#![allow(
    clippy::unwrap_used,
    clippy::float_cmp,
    reason = "in a test a panic is the message, and zero is exact"
)]

#[allow(dead_code, reason = "the tests of lumivox-app use the rest")]
#[path = "../../../../crates/lumivox-app/tests/it/common/mod.rs"]
mod common;
mod kernels;
mod motion;
mod quality;
mod rooms;
mod volumes;
mod voxels;

use lumivox_lab::run;

/// The tested program.
const PROGRAM: &str = env!("CARGO_BIN_EXE_lumivox-lab");
