//! Lines to be run by the console.

use lumivox_console::LineInfo;

/// The origin of a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A button, a slider or a key. Its line is dropped if a later line sets the same target before
    /// it runs.
    Panel,
    /// The window's console.
    Pane,
    /// The terminal that the program was started from, or its piped stdin.
    Terminal,
    /// A script that any of these has run.
    Script,
}

/// A line to run.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// The text, in the console's language.
    pub text: String,
    /// Its origin.
    pub origin: Origin,
    /// Number of the line among the window's lines; 0 for other lines.
    pub serial: u64,
    /// Number of the gesture, such as a drag, whose lines `undo` reverts together; 0 for a line
    /// that is its own step.
    pub gesture: u64,
}

impl Line {
    /// The target that the line sets; `None` if no later line may supersede it, as for typed lines.
    pub fn target(&self) -> Option<String> {
        if self.origin == Origin::Panel { LineInfo::of(&self.text).target } else { None }
    }
}

/// A word, quoted for a POSIX shell.
pub fn shell_quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn typed_lines_are_never_coalesced() {
        let line = |origin| Line { text: "bounces 1".to_owned(), origin, serial: 1, gesture: 0 };
        assert!(line(Origin::Panel).target().is_some());
        for origin in [Origin::Pane, Origin::Terminal, Origin::Script] {
            assert_eq!(line(origin).target(), None);
        }
    }

    #[test]
    #[cfg(unix)]
    fn shell_quoting_round_trips_words() {
        for word in ["plain", "it's", "a \"b\" $HOME `x` \\ c", "", "*", "#5", "a;b", "'"] {
            let command = format!("printf %s {}", shell_quoted(word));
            let output = std::process::Command::new("sh").args(["-c", &command]).output().unwrap();
            assert_eq!(String::from_utf8(output.stdout).unwrap(), word);
        }
    }
}
