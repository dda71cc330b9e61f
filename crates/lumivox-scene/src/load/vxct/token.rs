//! Tokens, which white space separates.

use std::str::CharIndices;

/// A place in the text, line and column from 1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Place {
    pub(super) line: u32,
    /// The column in characters.
    pub(super) column: u32,
}

impl std::fmt::Display for Place {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}:{}", self.line, self.column)
    }
}

/// A run of characters other than white space, with its place.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Token<'t> {
    pub(super) text: &'t str,
    pub(super) at: Place,
}

impl Token<'_> {
    /// Whether the token is a sign: `=`, `{` or `}`.
    pub(super) fn is_sign(&self) -> bool {
        matches!(self.text, "=" | "{" | "}")
    }
}

/// The tokens of a text, in order.
pub(super) struct Tokens<'t> {
    text: &'t str,
    chars: CharIndices<'t>,
    at: Place,
    after_return: bool,
}

impl<'t> Tokens<'t> {
    pub(super) fn new(text: &'t str) -> Self {
        // Some editors write a byte order mark.
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let at = Place { line: 1, column: 1 };
        Self { text, chars: text.char_indices(), at, after_return: false }
    }

    /// The place of the next character; after the last token, the end of the text.
    pub(super) fn place(&self) -> Place {
        self.at
    }

    /// Updates the place after a character. Lines end in LF, CR LF or CR.
    fn pass(&mut self, char: char) {
        let ends_line = char == '\r' || (char == '\n' && !self.after_return);
        if ends_line {
            self.at = Place { line: self.at.line.saturating_add(1), column: 1 };
        } else if char != '\n' {
            self.at.column = self.at.column.saturating_add(1);
        }
        self.after_return = char == '\r';
    }
}

impl<'t> Iterator for Tokens<'t> {
    type Item = Token<'t>;

    fn next(&mut self) -> Option<Token<'t>> {
        let mut begin = None;
        while let Some((index, char)) = self.chars.clone().next() {
            match (is_space(char), begin) {
                (true, Some((first, at))) => {
                    return Some(Token { text: &self.text[first..index], at });
                }
                (false, None) => begin = Some((index, self.at)),
                _ => {}
            }
            self.pass(char);
            self.chars.next();
        }
        begin.map(|(first, at)| Token { text: &self.text[first..], at })
    }
}

/// White space as in C: VXCT does not know Unicode's.
pub(super) fn is_space(char: char) -> bool {
    matches!(char, ' ' | '\t' | '\n' | '\r' | '\u{b}' | '\u{c}')
}

#[cfg(test)]
mod tests {
    use super::*;

    fn tokens(text: &str) -> Vec<(&str, u32, u32)> {
        Tokens::new(text).map(|token| (token.text, token.at.line, token.at.column)).collect()
    }

    #[test]
    fn only_white_space_separates_tokens() {
        assert_eq!(tokens(" a = b"), [("a", 1, 2), ("=", 1, 4), ("b", 1, 6)]);
        assert_eq!(tokens("a=b{c}"), [("a=b{c}", 1, 1)]);
        assert_eq!(
            tokens("x\t\u{b}y\u{c}z\u{a0}z"),
            [("x", 1, 1), ("y", 1, 4), ("z\u{a0}z", 1, 6)]
        );
        assert_eq!(tokens(" \r\n\t "), []);
        assert_eq!(tokens(""), []);
    }

    #[test]
    fn lines_and_characters_are_counted() {
        let all = [("a", 1, 1), ("b", 2, 2), ("c", 3, 1), ("d", 5, 1), ("e", 5, 3)];
        assert_eq!(tokens("a\n b\r\nc\r\rd e"), all);
        assert_eq!(tokens("äöü x\n€ y"), [("äöü", 1, 1), ("x", 1, 5), ("€", 2, 1), ("y", 2, 3)]);
        assert_eq!(tokens("\u{feff}a"), [("a", 1, 1)]);
        let mut ended = Tokens::new("a\n bc");
        while ended.next().is_some() {}
        assert_eq!(ended.place(), Place { line: 2, column: 4 });
    }

    #[test]
    fn signs_are_recognized_only_as_separate_tokens() {
        let signs: Vec<bool> = Tokens::new("= { } == {} a").map(|token| token.is_sign()).collect();
        assert_eq!(signs, [true, true, true, false, false, false]);
    }
}
