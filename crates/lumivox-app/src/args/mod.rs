//! What stands on the command line, value by value: each parser refuses by name and range.
//!
//! A value can be wrong in two ways. It may not be of the form asked for (`--size big`), which is a
//! mistake of usage; or it may be of that form but out of range (`--size 0x0`), which is bad input.
//! [`Refused`] keeps them apart, and the program's exit code says which it was: 2 or 3. A number out of
//! range is 3 whichever option it stands behind, and so is one that a script or a file gives.

pub mod choices;
pub mod output;
pub mod scene;
pub mod settings;

pub use lumivox_console::values::{Refused, camera, light, number, size};
