//! Escaping text for a terminal.
//!
//! Names of files and names in files come from strangers, and terminals obey control characters: an
//! escape sequence in the name of a material could recolour, overwrite or retitle what a user
//! reads. So everything printed for people goes through [`text`], and text that must stay on one
//! line through [`line()`]. Both replace control characters, and the marks that change the
//! direction of writing, by escapes in ASCII.

use std::borrow::Cow;
use std::fmt::Write as _;

pub use crate::is_obeyed;

/// Text of several lines, with all control characters but line feeds and tabs escaped.
pub fn text(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_obeyed(c) && !matches!(c, '\n' | '\t'), escape)
}

/// Text that stays on one line, such as a name, escaped in the same way.
pub fn line(text: &str) -> Cow<'_, str> {
    escaped(text, is_obeyed, escape)
}

/// JSON with the same meaning, whose strings have no characters that a terminal obeys.
pub fn json(text: &str) -> Cow<'_, str> {
    // ASCII control characters are escaped already, and the line feeds between values are not in
    // strings.
    escaped(
        text,
        |c| is_obeyed(c) && !c.is_ascii_control() || c == '\x7f',
        |c, out| {
            // None of these characters needs more than 16 bits.
            let _ = write!(out, "\\u{:04x}", c as u32);
        },
    )
}

fn escape(c: char, out: &mut String) {
    let _ = match c {
        '\n' => write!(out, "\\n"),
        '\r' => write!(out, "\\r"),
        '\t' => write!(out, "\\t"),
        c if c.is_ascii() => write!(out, "\\x{:02x}", c as u32),
        c => write!(out, "\\u{{{:x}}}", c as u32),
    };
}

fn escaped(
    text: &str,
    is_escaped: impl Fn(char) -> bool,
    escape: impl Fn(char, &mut String),
) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut out = String::with_capacity(text.len() + 16);
    for c in text.chars() {
        if is_escaped(c) { escape(c, &mut out) } else { out.push(c) }
    }
    Cow::Owned(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_control_and_direction_characters_are_escaped() {
        let plain = "a \"ünïcödé\" name, 日本語 ✓\n\tand a line";
        assert!(matches!(text(plain), Cow::Borrowed(same) if same == plain));
        assert_eq!(text("\x1b[31mred\x07\r\n"), "\\x1b[31mred\\x07\\r\n");
        assert_eq!(text("\u{9b}2J \u{202e}txt.exe\x7f\0"), "\\u{9b}2J \\u{202e}txt.exe\\x7f\\x00");
        assert_eq!(line("a\nerror: forged\tb"), "a\\nerror: forged\\tb");
    }

    #[test]
    fn escaped_json_decodes_to_the_same_text() {
        let name = "a\x1b[2J\u{9b}1m\x7f\u{202e}\n\"ü\"\u{2028}";
        let pretty = serde_json::to_string_pretty(&serde_json::json!({ "name": name })).unwrap();
        let shown = json(&pretty);
        assert!(!shown.chars().any(|c| is_obeyed(c) && c != '\n'), "{shown:?}");
        let back: serde_json::Value = serde_json::from_str(&shown).unwrap();
        assert_eq!(back["name"], name);
    }
}
