//! The console's lines, and messages of the status bar.

use std::collections::VecDeque;
use std::io::Write as _;
use std::sync::Arc;
use std::sync::mpsc::{self, Sender};
use std::thread::JoinHandle;
use std::time::Duration;

use lumivox_console::Names;

use crate::window::lines::Line;
use crate::window::model::{LogKind, LogLine};
use crate::window::terminal::Terminal;

/// Maximum number of lines.
const KEPT: usize = 2000;

/// The console's lines. They are also printed to stdout, to record mouse actions.
#[derive(Debug, Default)]
pub struct Log {
    lines: VecDeque<LogLine>,
    snapshot: Option<Arc<Vec<LogLine>>>,
    /// The last line's target, if a panel sent it, and whether it is printed already.
    last: Option<(Option<String>, bool)>,
    /// The thread that prints lines to stdout.
    printer: Option<(Sender<Printed>, JoinHandle<()>)>,
}

/// A message to the printing thread.
enum Printed {
    Text(String),
    Names(Names),
}

/// Maximum wait at the end for a blocked reader of stdout.
const PATIENCE: Duration = Duration::from_secs(2);

impl Log {
    /// Prints lines to a terminal from now on, on a thread: the terminal's reader may be slow.
    pub fn print_to(&mut self, mut terminal: Terminal) {
        let (sender, lines) = mpsc::channel();
        let thread = std::thread::spawn(move || {
            for line in lines {
                match line {
                    Printed::Text(text) => terminal.print(&text),
                    Printed::Names(names) => terminal.set_names(names),
                }
            }
            let _ = std::io::stdout().flush();
        });
        self.printer = Some((sender, thread));
    }

    /// Sets the terminal's names for completion.
    pub fn set_names(&self, names: &Names) {
        if let Some((printer, _)) = &self.printer {
            // The thread ends only after the sender is dropped.
            let _ = printer.send(Printed::Names(names.clone()));
        }
    }

    /// Adds a line that is run. It replaces the last line if both come from panels and have the
    /// same target.
    pub fn add_command(&mut self, line: &Line) {
        let target = line.target();
        let replaces =
            target.is_some() && self.last.as_ref().is_some_and(|(last, _)| *last == target);
        if replaces {
            self.lines.pop_back();
        } else {
            self.settle();
        }
        let is_final = target.is_none();
        self.push(LogKind::Command, &line.text);
        self.last = Some((target, false));
        if is_final {
            self.settle();
        }
    }

    /// Adds other text, unless it is empty.
    pub fn add(&mut self, kind: LogKind, text: &str) {
        if text.is_empty() {
            return;
        }
        self.settle();
        self.push(kind, text);
        self.last = Some((None, false));
        self.settle();
    }

    /// Whether the last command is not printed yet, since a later one may replace it.
    pub fn is_pending(&self) -> bool {
        self.last.as_ref().is_some_and(|(_, is_written)| !is_written)
    }

    /// Prints the last line if it is pending, and makes it final.
    pub fn settle(&mut self) {
        let Some((_, is_written)) = self.last.take() else { return };
        if let (false, Some(line)) = (is_written, self.lines.back()) {
            let mark = match line.kind {
                LogKind::Command => "> ",
                LogKind::Error => "error: ",
                LogKind::Reply | LogKind::Note => "",
            };
            let text = format!("{mark}{}", line.text);
            if let Some((printer, _)) = &self.printer {
                // The thread ends only after the sender is dropped.
                let _ = printer.send(Printed::Text(text));
            }
        }
    }

    /// Calls `settle` at the end, and waits for the printing thread.
    pub fn flush(&mut self) {
        self.settle();
        let Some((printer, thread)) = self.printer.take() else { return };
        drop(printer);
        crate::window::join(thread, PATIENCE);
    }

    fn push(&mut self, kind: LogKind, text: &str) {
        if self.lines.len() == KEPT {
            self.lines.pop_front();
        }
        self.lines.push_back(LogLine { kind, text: text.into() });
        self.snapshot = None;
    }

    /// The kept lines.
    pub fn snapshot(&mut self) -> Arc<Vec<LogLine>> {
        let lines = &self.lines;
        self.snapshot.get_or_insert_with(|| Arc::new(lines.iter().cloned().collect())).clone()
    }
}

/// Messages for the user.
#[derive(Default)]
pub struct Messages {
    pub log: Log,
    /// The last error, with its number.
    error: Option<(u64, String)>,
    /// The last requested command line, with its number.
    command_line: Option<(u64, String)>,
}

impl Messages {
    /// Shows an error in the console and in the status bar.
    pub fn fail(&mut self, error: &anyhow::Error) {
        let mut text = String::new();
        for cause in error.chain().map(ToString::to_string) {
            if text.is_empty() {
                text = cause;
            } else if !text.contains(&cause) {
                text += ": ";
                text += &cause;
            }
        }
        self.log.add(LogKind::Error, &text);
        let number = self.error.as_ref().map_or(0, |(number, _)| *number) + 1;
        self.error = Some((number, text));
    }

    /// Closes the error of this number.
    pub fn close_error(&mut self, number: u64) {
        self.error = self.error.take().filter(|(other, _)| *other != number);
    }

    /// The last error, with its number; `None` once closed.
    pub fn error(&self) -> Option<(u64, String)> {
        self.error.clone()
    }

    /// Provides a command line for the window to copy.
    pub fn copy(&mut self, line: String) {
        let number = self.command_line.as_ref().map_or(0, |(number, _)| *number) + 1;
        self.log.add(LogKind::Note, &format!("copied: {line}"));
        self.command_line = Some((number, line));
    }

    /// The last command line to copy, with its number.
    pub fn command_line(&self) -> Option<(u64, String)> {
        self.command_line.clone()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::window::lines::Origin;

    fn command(log: &mut Log, text: &str, origin: Origin) {
        log.add_command(&Line { text: text.to_owned(), origin, serial: 0, gesture: 0 });
    }

    fn texts(log: &mut Log) -> Vec<String> {
        log.snapshot().iter().map(|line| line.text.to_string()).collect()
    }

    #[test]
    fn the_log_shows_a_drag_as_one_line() {
        let mut log = Log::default();
        for value in ["1", "2", "3"] {
            command(&mut log, &format!("bounces {value}"), Origin::Panel);
        }
        assert_eq!(texts(&mut log), ["bounces 3"]);
        log.settle();
        command(&mut log, "bounces 4", Origin::Panel);
        command(&mut log, "bounces 5", Origin::Pane);
        command(&mut log, "bounces 6", Origin::Pane);
        assert_eq!(texts(&mut log), ["bounces 3", "bounces 4", "bounces 5", "bounces 6"]);
    }

    #[test]
    fn errors_stay_below_their_commands() {
        let mut log = Log::default();
        command(&mut log, "bounces 99", Origin::Panel);
        log.add(LogKind::Error, "too many");
        log.add(LogKind::Reply, "");
        command(&mut log, "bounces 3", Origin::Panel);
        assert_eq!(texts(&mut log), ["bounces 99", "too many", "bounces 3"]);
    }

    #[test]
    fn the_log_drops_its_oldest_lines() {
        let mut log = Log::default();
        for number in 0..KEPT + 5 {
            log.push(LogKind::Note, &number.to_string());
        }
        let texts = texts(&mut log);
        assert_eq!((texts.len(), texts[0].as_str()), (KEPT, "5"));
    }
}
