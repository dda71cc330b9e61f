//! The terminal beside the window.
//!
//! [`spawn`] reads lines in a thread of its own, and gives a printer that keeps what is printed clear of the line that is
//! being edited. The line that is edited when the program ends leaves the terminal as an editor needs it; [`Restore`]
//! gives it back as it was.

use std::io::{self, IsTerminal as _, Write as _};
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use lumivox_console::{Names, shown};

use crate::host::Host;
use crate::prompt::Prompt;

/// A terminal whose lines come over a channel.
#[derive(Debug)]
pub struct Terminal {
    names: Arc<Mutex<Names>>,
    printer: Printer,
}

enum Printer {
    /// Beside the line that is edited.
    Beside(Box<dyn FnMut(String) -> bool + Send>),
    /// Without a line to spare: stdin is no terminal.
    Plain,
}

impl std::fmt::Debug for Printer {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(if matches!(self, Self::Plain) { "Plain" } else { "Beside" })
    }
}

/// Reads lines in a thread of its own and sends them, until the other end is gone or there are no more: a prompt on a
/// terminal, else the lines of stdin as they come.
///
/// # Errors
/// When the system gives no thread.
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

/// Gives the terminal back as it was before [`spawn`] when it is dropped: the thread of the prompt is in the middle of a
/// line when the program ends. Without such a prompt it does nothing.
#[derive(Debug)]
pub struct Restore;

impl Drop for Restore {
    fn drop(&mut self) {
        mode::restore();
    }
}

/// How the terminal takes keys.
#[cfg(unix)]
mod mode {
    use std::io::{self, Write as _};
    use std::sync::{Mutex, PoisonError};

    use nix::sys::termios::{SetArg, Termios, tcgetattr, tcsetattr};

    /// Ends what an editor asks for besides: marks about what is pasted (DEC private mode 2004).
    const END_OF_PASTE_MARKS: &[u8] = b"\x1b[?2004l\n";

    static BEFORE: Mutex<Option<Termios>> = Mutex::new(None);

    /// Keeps how it is now; the first time counts.
    pub fn keep() {
        let mut before = BEFORE.lock().unwrap_or_else(PoisonError::into_inner);
        if before.is_none() {
            *before = tcgetattr(io::stdin()).ok();
        }
    }

    /// Makes it so again.
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

/// Consoles of Windows belong to the shell again once the program has ended.
#[cfg(not(unix))]
mod mode {
    pub fn keep() {}
    pub fn restore() {}
}

impl Terminal {
    /// What can be completed from now on.
    pub fn set_names(&self, names: Names) {
        *self.names.lock().unwrap_or_else(PoisonError::into_inner) = names;
    }

    /// Prints a line, or several, clear of what is being typed.
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
