//! Waiting lines: scripts, and lines of several commands.

use std::collections::VecDeque;

use super::line;
use crate::Failure;

/// The greatest depth of scripts that run scripts.
const DEEPEST: u32 = 16;

/// A waiting command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The command, or several with semicolons.
    pub text: String,
    /// The line's source, as in `file:12`; empty if typed.
    pub place: String,
    depth: u32,
}

impl Line {
    /// The line without a place, as if typed.
    pub(super) fn nowhere(self) -> Self {
        Self { place: String::new(), ..self }
    }
}

/// Commands in the order in which they run; those of [`super::Effect::Run`] come first.
#[derive(Clone, Debug, Default)]
pub struct Queue {
    lines: VecDeque<Line>,
    /// Nesting depth of scripts at the last taken line.
    depth: u32,
}

impl Queue {
    /// Adds a line at the end.
    pub fn add(&mut self, text: impl Into<String>, place: impl Into<String>) {
        self.lines.push_back(Line { text: text.into(), place: place.into(), depth: 0 });
    }

    /// Adds the lines of a script at the end.
    pub fn extend(&mut self, lines: Vec<Line>) {
        self.lines.extend(lines);
    }

    /// Takes the next line.
    pub fn take(&mut self) -> Option<Line> {
        let line = self.lines.pop_front()?;
        self.depth = line.depth;
        Some(line)
    }

    /// Puts lines before all others, as ordered by the last taken line.
    ///
    /// # Errors
    /// When scripts run each other without end.
    pub fn interpose(&mut self, lines: Vec<Line>) -> Result<(), Failure> {
        let depth = self.depth + 1;
        if depth > DEEPEST {
            return Err(Failure::input(format!(
                "scripts run scripts more than {DEEPEST} deep; does one run itself?"
            )));
        }
        for line in lines.into_iter().rev() {
            self.lines.push_front(Line { depth, ..line });
        }
        Ok(())
    }

    /// Drops the remaining lines of the script of the last taken line, and of the scripts that ran
    /// it. After an error a user does not expect them to continue.
    pub fn abandon(&mut self) {
        if self.depth > 0 {
            while self.lines.front().is_some_and(|line| line.depth > 0) {
                self.lines.pop_front();
            }
        }
    }
}

/// The commands of a script, each with its place in the file.
///
/// # Errors
/// When a quotation mark is open at the end of a line.
pub fn script(text: &str, file: &str) -> Result<Vec<Line>, Failure> {
    let mut lines = Vec::new();
    // Some editors put a byte order mark before UTF-8.
    for (index, text) in text.trim_start_matches('\u{feff}').lines().enumerate() {
        let place = format!("{file}:{}", index + 1);
        let commands = line::split(text).map_err(|e| Failure::input(format!("{place}: {e}")))?;
        for words in &commands {
            let text = line::text(text, words).to_owned();
            lines.push(Line { text, place: place.clone(), depth: 0 });
        }
    }
    Ok(lines)
}
