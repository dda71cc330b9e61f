//! Parsers of values on the command line; each error names the value and its range.
//!
//! A value can be wrong in two ways. It may not have the expected form (`--size big`), which is a
//! mistake of usage; or it may be out of range (`--size 0x0`), which is bad input. [`Refused`] and
//! the exit code (2 or 3) distinguish the two. A number out of range gives 3 for every option, and
//! also in scripts and files.

pub mod choices;
pub mod output;
pub mod scene;
pub mod settings;

pub use lumivox_console::values::{Refused, camera, light, number, size};
