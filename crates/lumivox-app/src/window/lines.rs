//! Lines on their way to the console.

use lumivox_console::{LineInfo, quote};

pub use lumivox_console::words;

/// Who wrote a line.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Origin {
    /// A button, a slider, a key: what it does to the state can be left out where a later line does it again.
    Panel,
    /// Somebody, in the window's console.
    Pane,
    /// The terminal that the program was started from, or what is piped into it.
    Terminal,
    /// A script that one of these runs.
    Script,
}

/// A line on its way.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Line {
    /// Of the console's language.
    pub text: String,
    /// Who wrote it.
    pub origin: Origin,
    /// Counts the window's lines; 0 for others.
    pub serial: u64,
    /// Counts what hands do, such as drags: the changes of one are one step for `undo`. 0 for what stands alone.
    pub gesture: u64,
}

impl Line {
    /// The target that it sets, if a later line may supersede it: typed lines are all run.
    pub fn target(&self) -> Option<String> {
        if self.origin == Origin::Panel { LineInfo::of(&self.text).target } else { None }
    }
}

/// A word that a POSIX shell splits into itself again.
pub fn shell_quoted(word: &str) -> String {
    let is_plain = |c: char| c.is_ascii_alphanumeric() || "-_./:=,+@%".contains(c);
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    format!("'{}'", word.replace('\'', "'\\''"))
}

/// A word that a line splits into itself again.
pub fn quoted(word: &str) -> String {
    quote(word)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_somebody_typed_is_done_as_it_was_typed() {
        let line = |origin| Line { text: "bounces 1".to_owned(), origin, serial: 1, gesture: 0 };
        assert!(line(Origin::Panel).target().is_some());
        for origin in [Origin::Pane, Origin::Terminal, Origin::Script] {
            assert_eq!(line(origin).target(), None);
        }
    }

    #[test]
    #[cfg(unix)]
    fn shells_give_words_back() {
        for word in ["plain", "it's", "a \"b\" $HOME `x` \\ c", "", "*", "#5", "a;b", "'"] {
            let command = format!("printf %s {}", shell_quoted(word));
            let output = std::process::Command::new("sh").args(["-c", &command]).output().unwrap();
            assert_eq!(String::from_utf8(output.stdout).unwrap(), word);
        }
    }

    #[test]
    fn quoted_names_come_back() {
        for name in ["plain", "with space", "a \"quoted\" one", "it's", "#5", "back\\slash", ""] {
            assert_eq!(words(&quoted(name)).unwrap(), [name]);
        }
    }
}
