//! A prompt on a terminal: line editing, history that is kept, completion, hints.
//!
//! [`Prompt`] reads lines for whoever waits for them; [`spawn`] reads them in a thread of its own, beside a window, and
//! gives a printer that keeps what is printed clear of the line that is being edited. The line that is edited when the
//! program ends leaves the terminal as an editor needs it; [`restore`] gives it back as it was.

use std::io::{self, IsTerminal as _, Write as _};
use std::path::PathBuf;
use std::sync::mpsc::Sender;
use std::sync::{Arc, Mutex, PoisonError};

use rustyline::completion::Completer;
use rustyline::error::ReadlineError;
use rustyline::highlight::Highlighter;
use rustyline::hint::Hinter;
use rustyline::history::FileHistory;
use rustyline::validate::Validator;
use rustyline::{Config, Context, Editor, ExternalPrinter, Helper};

use super::complete::{complete, files};
use super::{Command, Names, line};

/// What stands before a line.
const PROMPT: &str = "lumivox> ";
/// Lines of the history.
const HISTORY: usize = 1000;

/// What the editor asks while a line is typed.
#[derive(Debug, Default)]
struct Assistant {
    names: Arc<Mutex<Names>>,
}

impl Helper for Assistant {}
impl Highlighter for Assistant {}
impl Validator for Assistant {}

impl Completer for Assistant {
    type Candidate = String;

    fn complete(
        &self,
        text: &str,
        cursor: usize,
        _: &Context<'_>,
    ) -> rustyline::Result<(usize, Vec<String>)> {
        let names = self.names.lock().unwrap_or_else(PoisonError::into_inner);
        let completion = complete(&names, &files, text, cursor);
        Ok((completion.start, completion.candidates))
    }
}

impl Hinter for Assistant {
    type Hint = String;

    /// The arguments of a command whose name is complete.
    fn hint(&self, text: &str, cursor: usize, _: &Context<'_>) -> Option<String> {
        let commands = line::commands(text);
        let words = commands.last().filter(|words| words.len() == 1 && cursor == text.len())?;
        let name = words.first().filter(|_| text.ends_with(' '))?;
        let usage = Command::find(&name.text)?.usage;
        (!usage.is_empty()).then(|| usage.to_owned())
    }
}

/// A prompt.
pub struct Prompt {
    editor: Editor<Assistant, FileHistory>,
    names: Arc<Mutex<Names>>,
    history: Option<PathBuf>,
}

impl std::fmt::Debug for Prompt {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Prompt").field("history", &self.history).finish_non_exhaustive()
    }
}

/// Where the history is kept: the user's data folder, if there is one.
fn history_file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "lumivox")?;
    let folder = folders.data_dir();
    std::fs::create_dir_all(folder).ok()?;
    Some(folder.join("history.txt"))
}

impl Prompt {
    /// A prompt with the history of former ones.
    ///
    /// # Errors
    /// When there is no terminal.
    pub fn new() -> anyhow::Result<Self> {
        let config = Config::builder().max_history_size(HISTORY)?.auto_add_history(true).build();
        let mut editor = Editor::with_config(config)?;
        let names = Arc::new(Mutex::new(Names::default()));
        editor.set_helper(Some(Assistant { names: names.clone() }));
        let history = history_file();
        if let Some(file) = &history {
            // There is none at the first start.
            let _ = editor.load_history(file);
        }
        Ok(Self { editor, names, history })
    }

    /// What can be completed from now on.
    pub fn set_names(&self, names: Names) {
        *self.names.lock().unwrap_or_else(PoisonError::into_inner) = names;
    }

    /// The next line; `None` at the end (Ctrl-D). Ctrl-C drops a line.
    ///
    /// # Errors
    /// When the terminal fails.
    pub fn read(&mut self) -> anyhow::Result<Option<String>> {
        loop {
            match self.editor.readline(PROMPT) {
                Ok(line) => {
                    if let Some(file) = &self.history {
                        // A history that cannot be kept is no reason to stop.
                        let _ = self.editor.append_history(file);
                    }
                    return Ok(Some(line));
                }
                Err(ReadlineError::Interrupted) => {}
                Err(ReadlineError::Eof) => return Ok(None),
                Err(error) => return Err(error.into()),
            }
        }
    }
}

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
    let prompt = if io::stdin().is_terminal() { Prompt::new().ok() } else { None };
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
    let names = prompt.names.clone();
    let printer = match prompt.editor.create_external_printer() {
        Ok(mut printer) => Printer::Beside(Box::new(move |text| printer.print(text).is_ok())),
        Err(_) => Printer::Plain,
    };
    std::thread::Builder::new().name("prompt".to_owned()).spawn(move || {
        while let Ok(Some(line)) = prompt.read() {
            if lines.send(line).is_err() {
                break;
            }
        }
    })?;
    Ok(Terminal { names, printer })
}

/// Gives the terminal back as it was before [`spawn`]: the thread of the prompt is in the middle of a line when the
/// program ends. Without such a prompt it does nothing.
pub fn restore() {
    mode::restore();
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
        let done = match &mut self.printer {
            Printer::Beside(print) => print(format!("{text}\n")),
            Printer::Plain => false,
        };
        if !done {
            let _ = writeln!(io::stdout(), "{text}");
        }
    }
}
