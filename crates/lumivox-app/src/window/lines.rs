//! Lines on their way to the console: of several that set the same thing, the last counts.

use lumivox_console::quote;
use lumivox_render::parameters::Parameter;

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

/// Commands that set something to what they say and nothing else, by how many of their words name it.
const SETTERS: [(&str, usize); 12] = [
    ("camera", 1),
    ("compare_with", 1),
    ("environment", 1),
    ("environment_rotation", 1),
    ("light", 3),
    ("material", 3),
    ("place", 2),
    ("select", 1),
    ("size", 1),
    ("sky", 1),
    ("static", 2),
    ("time", 1),
];

/// What a line sets, where it does nothing but that: a later one with the same target makes it superfluous.
pub fn target(text: &str) -> Option<String> {
    let words = words(text)?;
    let name = words.first()?;
    let setter = SETTERS.iter().find(|(setter, _)| setter == name);
    let named_by = match setter {
        Some((_, named_by)) => *named_by,
        None if Parameter::find(name).is_some() => 1,
        None => return None,
    };
    (words.len() > named_by).then(|| words[..named_by].join("\u{0}"))
}

/// Leaves out what later lines of the panels do again. What is not of a panel, or does more than to set something, stays
/// where it is, and nothing moves past it.
pub fn coalesce(lines: Vec<Line>) -> Vec<Line> {
    let mut kept: Vec<(Option<String>, Line)> = Vec::new();
    for line in lines {
        let target = if line.origin == Origin::Panel { target(&line.text) } else { None };
        if target.is_some() {
            let run = kept.iter().rposition(|(target, _)| target.is_none()).map_or(0, |at| at + 1);
            if let Some(same) = kept[run..].iter().position(|(other, _)| *other == target) {
                kept.remove(run + same);
            }
        }
        kept.push((target, line));
    }
    kept.into_iter().map(|(_, line)| line).collect()
}

/// What does not wait for lines before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Urgent {
    /// Stop what is under way.
    Cancel,
    /// End.
    Quit,
}

/// Whether a line is such.
pub fn urgent(text: &str) -> Option<Urgent> {
    match text.trim() {
        "cancel" => Some(Urgent::Cancel),
        "quit" | "exit" | "q" => Some(Urgent::Quit),
        _ => None,
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

    fn after(lines: &[(&str, Origin)]) -> Vec<String> {
        let lines = lines.iter().enumerate().map(|(serial, (text, origin))| Line {
            text: (*text).to_owned(),
            origin: *origin,
            serial: serial as u64 + 1,
            gesture: 0,
        });
        coalesce(lines.collect()).into_iter().map(|line| line.text).collect()
    }

    fn of_panels(lines: &[&str]) -> Vec<String> {
        after(&lines.iter().map(|line| (*line, Origin::Panel)).collect::<Vec<_>>())
    }

    #[test]
    fn the_last_value_of_a_parameter_counts() {
        let lines = ["bounces 1", "exposure 2", "bounces 2", "bounces 3"];
        assert_eq!(of_panels(&lines), ["exposure 2", "bounces 3"]);
    }

    #[test]
    fn objects_are_told_apart() {
        let lines =
            ["place a 1 0 0 0 0 0 1", "place \"b c\" 1 0 0 0 0 0 1", "place a 2 0 0 0 0 0 1"];
        assert_eq!(of_panels(&lines), [lines[1], lines[2]]);
        let lines =
            ["light lamp position 1 2 3", "light lamp color 1 1 1", "light lamp position 4 5 6"];
        assert_eq!(of_panels(&lines), [lines[1], lines[2]]);
    }

    #[test]
    fn nothing_moves_past_what_does_more() {
        let lines = ["bounces 1", "preset high", "bounces 2"];
        assert_eq!(of_panels(&lines), lines);
        // These add up, or print.
        for lines in [["translate a 1 0 0", "translate a 1 0 0"], ["bounces", "bounces"]] {
            assert_eq!(of_panels(&lines), lines);
        }
    }

    #[test]
    fn what_somebody_typed_is_done_as_it_was_typed() {
        for origin in [Origin::Pane, Origin::Terminal] {
            let lines = [("bounces 1", origin), ("bounces 2", origin)];
            assert_eq!(after(&lines), ["bounces 1", "bounces 2"]);
        }
        let lines = [
            ("bounces 1", Origin::Panel),
            ("bounces 2", Origin::Pane),
            ("bounces 3", Origin::Panel),
        ];
        assert_eq!(after(&lines).len(), 3);
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
    fn what_is_urgent_is_told_from_what_only_looks_like_it() {
        assert_eq!(urgent(" quit "), Some(Urgent::Quit));
        assert_eq!(urgent("cancel"), Some(Urgent::Cancel));
        assert_eq!(urgent("echo quit"), None);
    }

    #[test]
    fn quoted_names_come_back() {
        for name in ["plain", "with space", "a \"quoted\" one", "it's", "#5", "back\\slash", ""] {
            assert_eq!(words(&quoted(name)).unwrap(), [name]);
        }
    }
}
