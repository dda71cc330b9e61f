//! The terminal beside the window.
//!
//! [`spawn`] reads lines on its own thread; its [`Terminal`] prints above the line being edited. If
//! the program ends during editing, the terminal is still in the editor's mode; [`Restore`] resets
//! it.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use lumivox_console::{Names, shown};

use crate::host::Host;
use crate::prompt::Prompt;

/// A terminal whose lines are sent over a channel.
#[derive(Debug)]
pub struct Terminal {
    names: Arc<Mutex<Names>>,
    printer: Printer,
}

enum Printer {
    /// Prints above the line being edited.
    Beside(Box<dyn FnMut(String) -> bool + Send>),
    /// Prints to stdout directly.
    Plain,
}

impl std::fmt::Debug for Printer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if matches!(self, Self::Plain) { "Plain" } else { "Beside" })
    }
}

/// Reads lines on its own thread and sends them, until the receiver is gone or the input ends: from
/// a prompt if stdin is a terminal, else from stdin.
///
/// # Errors
/// When the thread cannot be started.
pub fn spawn(lines: Sender<String>) -> io::Result<Terminal> {
    if io::stdin().is_terminal() {
        mode::keep();
    }
    let prompt =
        if io::stdin().is_terminal() { Prompt::new(&Host::of_process()).ok() } else { None };
    let Some(mut prompt) = prompt else {
        std::thread::Builder::new().name("stdin".to_owned()).spawn(move || {
            let read = io::stdin().lines().map_while(Result::ok);
            for line in read {
                if lines.send(line).is_err() {
                    break;
                }
            }
        })?;
        return Ok(Terminal { names: Arc::default(), printer: Printer::Plain });
    };
    let names = prompt.names();
    let printer = prompt.printer().map_or(Printer::Plain, Printer::Beside);
    std::thread::Builder::new().name("prompt".to_owned()).spawn(move || {
        while let Ok(Some(line)) = prompt.read() {
            if lines.send(line).is_err() {
                break;
            }
        }
    })?;
    Ok(Terminal { names, printer })
}

/// When dropped, restores the terminal's mode from before [`spawn`]: the prompt's thread may be
/// editing a line when the program ends. Does nothing without a prompt.
#[derive(Debug)]
pub struct Restore;

impl Drop for Restore {
    fn drop(&mut self) {
        mode::restore();
    }
}

/// The terminal's input mode.
#[cfg(unix)]
mod mode {
    use std::io::{self, Write as _};
    use std::sync::{Mutex, PoisonError};

    use nix::sys::termios::{SetArg, Termios, tcgetattr, tcsetattr};

    /// Turns off bracketed paste (DEC private mode 2004), which the editor turns on.
    const END_OF_PASTE_MARKS: &[u8] = b"\x1b[?2004l\n";

    static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);

    /// Saves the current mode; only the first call counts.
    pub fn keep() {
        let mut before = BEFORE.lock().unwrap_or_else(PoisonError::into_inner);
        if before.is_none() {
            *before = tcgetattr(io::stdin()).ok();
        }
    }

    /// Restores the saved mode.
    pub fn restore() {
        let before = BEFORE.lock().unwrap_or_else(PoisonError::into_inner).take();
        let Some(before) = before else { return };
        let is_changed = tcgetattr(io::stdin()).is_ok_and(|now| now != before);
        if is_changed && tcsetattr(io::stdin(), SetArg::TCSADRAIN, &before).is_ok() {
            let mut out = io::stdout().lock();
            let _ = out.write_all(END_OF_PASTE_MARKS).and_then(|()| out.flush());
        }
    }
}

/// Not needed on Windows: the shell resets the console when the program ends.
#[cfg(not(unix))]
mod mode {
    pub fn keep() {}
    pub fn restore() {}
}

impl Terminal {
    /// Sets the names for completion.
    pub fn set_names(&self, names: Names) {
        *self.names.lock().unwrap_or_else(PoisonError::into_inner) = names;
    }

    /// Prints one or more lines above the line being typed.
    pub fn print(&mut self, text: &str) {
        let text = shown::text(text);
        let done = match &mut self.printer {
            Printer::Beside(print) => print(format!("{text}\n")),
            Printer::Plain => false,
        };
        if !done {
            let _ = writeln!(io::stdout(), "{text}");
        }
    }
}
