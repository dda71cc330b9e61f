//! Errors for people, with the kind of their cause.

use std::fmt;

/// The cause of an error.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Blame {
    /// Bad input.
    Input,
    /// No display for a window.
    Display,
    /// The user stopped the work.
    Stopped,
    /// An output that cannot be written.
    Output,
}

/// An error found by a check, before something fails. Its message names the fault and the remedy.
#[derive(Debug)]
pub struct Failure {
    /// The cause.
    pub blame: Blame,
    message: String,
}

impl Failure {
    fn new(blame: Blame, message: impl Into<String>) -> Self {
        Self { blame, message: message.into() }
    }

    /// Bad input.
    pub fn input(message: impl Into<String>) -> Self {
        Self::new(Blame::Input, message)
    }

    /// No display for a window.
    pub fn display(message: impl Into<String>) -> Self {
        Self::new(Blame::Display, message)
    }

    /// The user stopped the work; the message says how much is done.
    pub fn stopped(message: impl Into<String>) -> Self {
        Self::new(Blame::Stopped, message)
    }

    /// An output that cannot be written.
    pub fn output(message: impl Into<String>) -> Self {
        Self::new(Blame::Output, message)
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Failure {}
