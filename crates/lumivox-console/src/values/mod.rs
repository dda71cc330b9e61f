//! Values that are written as text: for the console's commands, for options of a command line.
//!
//! A value can be wrong in two ways. It may not be of the form asked for (`big` for a size), or it
//! may be of that form but out of range (`0x0`). [`Refused`] keeps them apart, and is all that goes
//! wrong here.

#![allow(clippy::missing_errors_doc, reason = "said once for all readers of values")]

pub mod camera;
pub mod choices;
pub mod light;
pub mod load;
pub mod number;
pub mod size;

use std::fmt;

/// Why a value of the command line is refused.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Refused {
    /// It does not have the form asked for.
    Malformed(String),
    /// It has, but lies where it must not.
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
