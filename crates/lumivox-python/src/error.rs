//! Errors as the exceptions of the package: `lumivox.errors`.

use lumivox_app::Exit;
use pyo3::prelude::*;

/// An error that Python will raise; it can be created without the global lock.
#[derive(Debug)]
pub enum Fault {
    /// An error of Lumivox.
    Ours(anyhow::Error),
    /// An exception of Python: of a callback, or `KeyboardInterrupt`.
    Python(PyErr),
}

impl<E: Into<anyhow::Error>> From<E> for Fault {
    fn from(error: E) -> Self {
        Self::Ours(error.into())
    }
}

impl Fault {
    /// Bad input, with the message.
    pub fn input(message: impl Into<String>) -> Self {
        Self::Ours(lumivox_console::Failure::input(message).into())
    }

    /// The exception. Its class follows from the exit code that the program would have.
    pub fn raise(self, py: Python<'_>) -> PyErr {
        let error = match self {
            Self::Ours(error) => error,
            Self::Python(error) => return error,
        };
        let class = match lumivox_app::exit_of(&error) {
            Exit::Input | Exit::Usage => "InputError",
            Exit::Gpu => "GpuError",
            Exit::Output => "OutputError",
            Exit::Ok | Exit::Internal | Exit::Stopped => "Error",
        };
        let mut message = String::new();
        for cause in error.chain() {
            let text = cause.to_string();
            // Some messages of other crates already contain their causes.
            if message.is_empty() {
                message = text;
            } else if !message.contains(&text) {
                message = format!("{message}; because: {text}");
            }
        }
        let made = py
            .import("lumivox.errors")
            .and_then(|module| module.getattr(class))
            .and_then(|class| class.call1((message,)));
        made.map_or_else(|error| error, PyErr::from_value)
    }
}
