//! Commands that only the window has: scripts that were written there run without it, past them.

use super::split;

/// Their names.
const OWN: [&str; 5] = ["select", "compare_with", "cancel", "fullscreen", "lose_device"];

/// Whether a line is a command that only the window has; its name.
pub fn own_command(text: &str) -> Option<&'static str> {
    let words = words(text)?;
    OWN.into_iter().find(|own| words.first().is_some_and(|name| name == own))
}

/// The words of a line of one command.
pub fn words(text: &str) -> Option<Vec<String>> {
    let commands = split(text).ok()?;
    let [words] = commands.as_slice() else { return None };
    Some(words.iter().map(|word| word.text.clone()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn commands_of_the_window_are_told_from_what_only_looks_like_them() {
        assert_eq!(own_command("select 'a b'"), Some("select"));
        assert_eq!(own_command("selected"), None);
    }
}
