//! Lines of the console's language, split into commands and words.
//!
//! Words are separated by white space. Single quotes keep everything between them unchanged. Within
//! double quotes `\"` and `\\` mean the mark and the backslash, and `\u{1b}` the character of that
//! number, so that names with line feeds or control characters can be written. Elsewhere a
//! backslash is an ordinary character, so that paths of Windows need no quotes. A semicolon or a
//! line feed ends a command; a `#` at the start of a word begins a comment, which goes to the end
//! of the line.
//!
//! This file needs only the standard library, so that `fuzz/` can include it.

use std::fmt;
use std::ops::Range;

/// A line that cannot be split.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LineError {
    /// The mark that is not closed.
    pub mark: char,
    /// Its column: a character of the line, from 1.
    pub column: usize,
}

impl fmt::Display for LineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { mark, column } = self;
        write!(
            f,
            "the quotation mark {mark} at column {column} is open at the end of the line; close it"
        )
    }
}

impl std::error::Error for LineError {}

/// Whether a terminal obeys the character instead of showing it: control characters, separators of
/// lines and paragraphs, and marks that change the direction of writing.
pub fn is_obeyed(c: char) -> bool {
    c.is_control() || matches!(c, '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
}

/// A word of a line.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Word {
    /// The word without its quotation marks.
    pub text: String,
    /// The word's bytes in the line, with quotation marks.
    pub range: Range<usize>,
    /// The quotation mark still open at the word's end, and its byte offset in the line.
    pub open: Option<(char, usize)>,
}

/// A command: its words in order, at least one.
pub type Words = Vec<Word>;

/// The commands of a line, complete or not.
pub fn commands(line: &str) -> Vec<Words> {
    let mut commands = vec![Words::new()];
    let mut rest = line.char_indices().peekable();
    while let Some(&(start, first)) = rest.peek() {
        match first {
            ';' | '\n' => {
                rest.next();
                commands.push(Words::new());
            }
            '#' => while rest.next_if(|(_, c)| *c != '\n').is_some() {},
            c if c.is_whitespace() => {
                rest.next();
            }
            _ => {
                let word = word(line, start, &mut rest);
                if let Some(last) = commands.last_mut() {
                    last.push(word);
                }
            }
        }
    }
    commands.retain(|words| !words.is_empty());
    commands
}

/// The commands of a line, each split into its words; none for a comment.
///
/// # Errors
/// [`LineError`] when a quotation mark is open at the end.
pub fn split(line: &str) -> Result<Vec<Words>, LineError> {
    let commands = commands(line);
    for word in commands.iter().flatten() {
        if let Some((mark, at)) = word.open {
            let before = line.get(..at).unwrap_or_default();
            return Err(LineError { mark, column: before.chars().count() + 1 });
        }
    }
    Ok(commands)
}

/// The text of a command within its line.
pub fn text<'a>(line: &'a str, words: &[Word]) -> &'a str {
    let (Some(first), Some(last)) = (words.first(), words.last()) else { return "" };
    line.get(first.range.start..last.range.end).unwrap_or_default()
}

/// Quotes a word so that a line reads it unchanged, in printable characters.
pub fn quote(word: &str) -> String {
    if word.contains(is_obeyed) {
        let mut quoted = String::from("\"");
        for c in word.chars() {
            match c {
                '"' | '\\' => quoted.extend(['\\', c]),
                c if is_obeyed(c) => quoted.push_str(&format!("\\u{{{:x}}}", c as u32)),
                c => quoted.push(c),
            }
        }
        return quoted + "\"";
    }
    let is_plain = |c: char| !c.is_whitespace() && !matches!(c, '"' | '\'' | ';' | '#');
    if !word.is_empty() && word.chars().all(is_plain) {
        return word.to_owned();
    }
    if !word.contains('\'') {
        return format!("'{word}'");
    }
    let escaped = word.replace('\\', "\\\\").replace('"', "\\\"");
    format!("\"{escaped}\"")
}

/// Reads `u{1b}` at the start of a text. Returns the character and the escape's length.
fn numbered(text: &str) -> Option<(char, usize)> {
    let (digits, _) = text.strip_prefix("u{")?.split_once('}')?;
    let is_number =
        (1..=6).contains(&digits.len()) && digits.bytes().all(|b| b.is_ascii_hexdigit());
    let number = u32::from_str_radix(digits, 16).ok().filter(|_| is_number)?;
    Some((char::from_u32(number)?, digits.len() + 3))
}

fn word(
    line: &str,
    start: usize,
    rest: &mut std::iter::Peekable<std::str::CharIndices<'_>>,
) -> Word {
    let mut text = String::new();
    let mut open = None;
    while let Some(&(at, c)) = rest.peek() {
        match (open, c) {
            (None, '"' | '\'') => open = Some((c, at)),
            (None, ';') => break,
            (None, c) if c.is_whitespace() => break,
            (Some((mark, _)), c) if mark == c => open = None,
            (Some(('"', _)), '\\') => {
                rest.next();
                if let Some((escaped, length)) = numbered(&line[at + 1..]) {
                    text.push(escaped);
                    // Skip all but the last character; `rest.next()` below takes that one.
                    rest.nth(length - 2);
                } else if let Some(&(_, escaped @ ('"' | '\\'))) = rest.peek() {
                    text.push(escaped);
                } else {
                    text.push('\\');
                    continue;
                }
            }
            (_, c) => text.push(c),
        }
        rest.next();
    }
    let end = rest.peek().map_or(line.len(), |(end, _)| *end);
    Word { text, range: start..end, open }
}
