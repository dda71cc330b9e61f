//! The classics against closed forms, definitions and Lumivox's own methods.

mod locks;
mod photons;
mod report;
#[allow(dead_code)] // Lumivox's own tests use the rest, here and below.
#[path = "../../../../crates/lumivox/src/testing/mod.rs"]
mod testing;
#[allow(dead_code)]
mod voxelize;

use testing as common;
