//! The end of the program: exit codes, error messages, and panics.

use std::fmt;
use std::io::Write as _;
use std::process::ExitCode;

use lumivox::GiError;
use lumivox_console::values::Refused;
use lumivox_console::{Blame, Failure, shown};
use lumivox_explorer::ExplorerError;
use lumivox_render::RenderError;
use lumivox_render::compare::CompareError;
use lumivox_render::reference::PartError;
use lumivox_scene::SceneError;

/// The exit codes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Exit {
    /// Success.
    Ok = 0,
    /// The GPU failed, or Lumivox has a defect.
    Internal = 1,
    /// The command line is malformed.
    Usage = 2,
    /// A scene is broken, or a value out of range.
    Input = 3,
    /// There is no suitable GPU, the GPU is too small, or there is no display.
    Gpu = 4,
    /// The output cannot be written.
    Output = 5,
    /// The user pressed Ctrl-C: 128 and the number of the signal, as in shells.
    Stopped = 130,
}

/// The exit codes, for the help.
pub const CODES: &str = "\
Exit codes:
  0  all went well
  1  the GPU failed, or Lumivox has a defect
  2  the command line cannot be understood
  3  bad input: a scene that cannot be read, or a value out of range, wherever it stands
  4  no suitable GPU, no display for a window, or more asked for than the GPU can hold
  5  the output cannot be written, or another process is writing it
  130  stopped by Ctrl-C; what a sequence, a reference or a measurement had by then is kept";

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Several errors that were reported already, with the exit code of the first.
#[derive(Debug)]
pub struct Told {
    /// The exit code of the first error.
    pub exit: Exit,
    /// The message: the number of errors.
    pub message: String,
}

impl fmt::Display for Told {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.message)
    }
}

impl std::error::Error for Told {}

/// An error in a line of a script.
#[derive(Debug)]
pub struct Located {
    place: String,
    error: anyhow::Error,
}

impl Located {
    /// `place` is `FILE:LINE`, or empty.
    pub fn new(place: impl Into<String>, error: anyhow::Error) -> Self {
        Self { place: place.into(), error }
    }
}

impl fmt::Display for Located {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.place.is_empty() {
            self.error.fmt(f)
        } else {
            write!(f, "{}: {}", self.place, self.error)
        }
    }
}

impl std::error::Error for Located {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        self.error.source()
    }
}

/// The exit code for an error of a command.
pub fn of_error(error: &anyhow::Error) -> Exit {
    for cause in error.chain() {
        if let Some(failure) = cause.downcast_ref::<Failure>() {
            return of_blame(failure.blame);
        }
        if let Some(told) = cause.downcast_ref::<Told>() {
            return told.exit;
        }
        if let Some(located) = cause.downcast_ref::<Located>() {
            return of_error(&located.error);
        }
        if let Some(error) = cause.downcast_ref::<SceneError>() {
            return of_scene_error(error);
        }
        if let Some(error) = cause.downcast_ref::<RenderError>() {
            return of_render_error(error);
        }
        // `source` of this error skips the wrapped error.
        match cause.downcast_ref::<ExplorerError>() {
            Some(ExplorerError::Render(error)) => return of_render_error(error),
            Some(ExplorerError::Scene(error)) => return of_scene_error(error),
            _ => {}
        }
        if cause.is::<CompareError>() || cause.is::<PartError>() {
            return Exit::Input;
        }
        if let Some(error) = cause.downcast_ref::<GiError>() {
            return of_gi_error(error);
        }
    }
    Exit::Internal
}

fn of_blame(blame: Blame) -> Exit {
    match blame {
        Blame::Input => Exit::Input,
        Blame::Display => Exit::Gpu,
        Blame::Stopped => Exit::Stopped,
        Blame::Output => Exit::Output,
    }
}

fn of_scene_error(error: &SceneError) -> Exit {
    let is_output = matches!(error, SceneError::Write { .. });
    if is_output { Exit::Output } else { Exit::Input }
}

fn of_render_error(error: &RenderError) -> Exit {
    match error {
        RenderError::Adapter { .. }
        | RenderError::NoDevice { .. }
        | RenderError::Limit { .. }
        | RenderError::OutOfMemory { .. } => Exit::Gpu,
        RenderError::Setting { .. }
        | RenderError::NothingToVoxelize { .. }
        | RenderError::UnknownFormat { .. }
        | RenderError::Reference { .. } => Exit::Input,
        RenderError::Write { .. } => Exit::Output,
        RenderError::Gi(error) => of_gi_error(error),
        _ => Exit::Internal,
    }
}

fn of_gi_error(error: &GiError) -> Exit {
    match error {
        GiError::Limit { .. } | GiError::Budget { .. } => Exit::Gpu,
        GiError::Setting { .. } | GiError::Geometry { .. } | GiError::NothingToVoxelize { .. } => {
            Exit::Input
        }
        _ => Exit::Internal,
    }
}

/// The exit code of an error of the command line, or of a request for help.
pub fn of_clap(error: &clap::Error) -> Exit {
    let refused = std::error::Error::source(error).and_then(|e| e.downcast_ref::<Refused>());
    match (error.use_stderr(), refused) {
        (false, _) => Exit::Ok,
        (true, Some(Refused::OutOfRange(_))) => Exit::Input,
        (true, _) => Exit::Usage,
    }
}

/// The message for an error: one line, then one for each cause.
pub fn message(error: &anyhow::Error) -> String {
    // A stop by the user is not an error.
    let start = if of_error(error) == Exit::Stopped { "" } else { "error: " };
    let mut text = String::new();
    let mut said = String::new();
    for cause in error.chain() {
        let line = one_line(&cause.to_string());
        // Messages of lower crates already include their causes.
        if text.is_empty() {
            text = format!("{start}{line}\n");
        } else if !said.contains(&line) {
            text += &format!("  because: {line}\n");
        }
        said = line;
    }
    text
}

fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Runs `work`; a panic in it becomes an apology and [`Exit::Internal`].
///
/// The stack is unwound first, so that temporary files are removed.
pub fn guard(work: impl FnOnce() -> Exit + std::panic::UnwindSafe) -> Exit {
    std::panic::set_hook(Box::new(|info| {
        let reason = info.payload_as_str().unwrap_or("no reason given");
        let place = info.location().map(|place| format!(" (at {place})")).unwrap_or_default();
        let text = format!(
            "error: {}{place}\nSorry, this is a defect of Lumivox. Please report it with this \
             message and the command line.\n",
            one_line(reason)
        );
        let _ = std::io::stderr().write_all(shown::text(&text).as_bytes());
    }));
    std::panic::catch_unwind(work).unwrap_or(Exit::Internal)
}

#[cfg(test)]
mod tests {
    use anyhow::Context as _;

    use super::*;

    #[test]
    fn exit_codes_survive_added_error_context() {
        let codes = |error: anyhow::Error| of_error(&error.context("in some command"));
        let known = Vec::new();
        let unknown = SceneError::UnknownBuiltin { name: String::new(), known };
        assert_eq!(codes(unknown.into()), Exit::Input);
        let empty = SceneError::NothingAtTime { file: "a".into(), time_s: 1.0 };
        assert_eq!(codes(ExplorerError::from(empty).into()), Exit::Input);
        let source = std::io::Error::other("the disk is full");
        let unwritten = SceneError::Write { file: "a".into(), source };
        assert_eq!(codes(unwritten.into()), Exit::Output);
        let limit = || GiError::Limit {
            what: String::new(),
            needed: 2,
            unit: "bytes",
            limit: "max_buffer_size",
            available: 1,
            remedy: String::new(),
        };
        assert_eq!(codes(limit().into()), Exit::Gpu);
        assert_eq!(codes(RenderError::Gi(limit()).into()), Exit::Gpu);
        assert_eq!(codes(ExplorerError::from(RenderError::Gi(limit())).into()), Exit::Gpu);
        let write = RenderError::Write { file: "a".into(), reason: String::new() };
        assert_eq!(codes(write.into()), Exit::Output);
        assert_eq!(codes(anyhow::anyhow!("who knows")), Exit::Internal);
        assert_eq!(codes(Failure::output("full").into()), Exit::Output);
        let nested: anyhow::Result<()> = Err(Failure::input("bad")).context("outer");
        assert_eq!(codes(nested.unwrap_err()), Exit::Input);
    }

    #[test]
    fn a_panic_becomes_an_exit_code() {
        assert_eq!(guard(|| panic!("a test of the apology")), Exit::Internal);
        assert_eq!(guard(|| Exit::Ok), Exit::Ok);
        drop(std::panic::take_hook());
    }

    #[test]
    fn messages_are_joined_to_one_line() {
        assert_eq!(
            one_line("Validation error\n\n  in this:\n\tthat"),
            "Validation error in this: that"
        );
    }
}
