//! A prompt on a terminal with line editing, a saved history, completion and hints.

use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use lumivox_console::complete::complete;
use lumivox_console::{Command, Names, begun};
use rustyline::completion::Completer;
use rustyline::error::ReadlineError;
use rustyline::highlight::Highlighter;
use rustyline::hint::Hinter;
use rustyline::history::FileHistory;
use rustyline::validate::Validator;
use rustyline::{Config, Context, Editor, ExternalPrinter, Helper};

use crate::disk::files;
use crate::host::Host;

/// The text of the prompt.
const PROMPT: &str = "lumivox> ";
/// Maximum lines of the history.
const HISTORY: usize = 1000;

/// The line editor's helper: completion and hints.
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

    /// A command's arguments, once its name and a space are typed.
    fn hint(&self, text: &str, cursor: usize, _: &Context<'_>) -> Option<String> {
        let commands = begun(text);
        let words = commands.last().filter(|words| words.len() == 1 && cursor == text.len())?;
        let name = words.first().filter(|_| text.ends_with(' '))?;
        let usage = Command::find(&name.text)?.usage;
        (!usage.is_empty()).then(|| usage.to_owned())
    }
}

/// A prompt with line editing.
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

/// The file of the history, in the user's data folder if there is one.
fn history_file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "lumivox")?;
    let folder = folders.data_dir();
    std::fs::create_dir_all(folder).ok()?;
    Some(folder.join("history.txt"))
}

impl Prompt {
    /// A prompt on the process's terminal, with the saved history.
    ///
    /// # Errors
    /// When there is no terminal.
    pub fn new(_: &Host) -> anyhow::Result<Self> {
        let config = Config::builder().max_history_size(HISTORY)?.auto_add_history(true).build();
        let mut editor = Editor::with_config(config)?;
        let names = Arc::new(Mutex::new(Names::default()));
        editor.set_helper(Some(Assistant { names: names.clone() }));
        let history = history_file();
        if let Some(file) = &history {
            // The file does not exist on the first run.
            let _ = editor.load_history(file);
        }
        Ok(Self { editor, names, history })
    }

    /// Sets the names that can be completed.
    pub fn set_names(&self, names: Names) {
        *self.names.lock().unwrap_or_else(PoisonError::into_inner) = names;
    }

    /// The names that can be completed, shared so that other threads can change them.
    pub fn names(&self) -> Arc<Mutex<Names>> {
        self.names.clone()
    }

    /// A printer that writes above the edited line; `None` if the terminal does not support it. The
    /// printer returns whether it has printed.
    pub fn printer(&mut self) -> Option<Box<dyn FnMut(String) -> bool + Send>> {
        let mut printer = self.editor.create_external_printer().ok()?;
        Some(Box::new(move |text| printer.print(text).is_ok()))
    }

    /// The next line; `None` at the end (Ctrl-D). Ctrl-C discards a line.
    ///
    /// # Errors
    /// When the terminal fails.
    pub fn read(&mut self) -> anyhow::Result<Option<String>> {
        loop {
            match self.editor.readline(PROMPT) {
                Ok(line) => {
                    if let Some(file) = &self.history {
                        // Failing to save the history is not an error.
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
