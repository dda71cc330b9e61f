//! The program `lumivox`, as the package installs it.

use std::ffi::OsString;

use pyo3::prelude::*;

/// Runs a command line, whose first word is the program's name; returns the exit code.
#[pyfunction]
pub fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    py.detach(|| {
        lumivox_app::guard(|| lumivox_app::run(arguments, &lumivox_app::Host::of_process())) as u8
    })
}
