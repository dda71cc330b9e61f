//! Values as text, for the console's commands and the options of a command line.
//!
//! A value can be wrong in two ways: it may not have the expected form (`big` for a size), or it
//! may be out of range (`0x0`). [`Refused`] distinguishes the two, and is the only error here.

#![allow(clippy::missing_errors_doc, reason = "said once for all readers of values")]

pub mod camera;
pub mod choices;
pub mod light;
pub mod load;
pub mod number;
pub mod size;

use std::fmt;

/// Why a value is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// It does not have the expected form.
    Malformed(String),
    /// It has the expected form, but is out of range.
    OutOfRange(String),
}

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Malformed(reason) | Self::OutOfRange(reason) => f.write_str(reason),
        }
    }
}

impl std::error::Error for Refused {}
