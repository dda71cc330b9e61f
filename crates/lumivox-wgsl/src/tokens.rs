//! The tokens of WGSL.

/// The kind of a token.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// A name or a keyword.
    Word,
    /// A number.
    Number,
    /// One character of punctuation.
    Symbol,
    /// A comment, without the end of its line.
    Comment,
    /// The rest of a source after a `/*` that is not closed.
    Unclosed,
    /// White space.
    Space,
}

/// A piece of source text.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Token<'a> {
    pub(crate) kind: Kind,
    pub(crate) text: &'a str,
    /// Its line, from 1.
    pub(crate) line: u32,
}

impl Token<'_> {
    pub(crate) fn is(&self, text: &str) -> bool {
        self.text == text
    }

    /// Whether it is neither a comment nor white space.
    pub(crate) fn is_code(&self) -> bool {
        !matches!(self.kind, Kind::Comment | Kind::Space)
    }
}

/// All tokens of a source; their joined text is the source.
pub(crate) fn tokens(source: &str) -> Vec<Token<'_>> {
    let mut found = Vec::new();
    let (mut rest, mut line) = (source, 1);
    while let Some(first) = rest.chars().next() {
        let (kind, length) = match first {
            _ if first.is_whitespace() => (Kind::Space, run(rest, char::is_whitespace)),
            _ if rest.starts_with("//") => (Kind::Comment, run(rest, |c| c != '\n')),
            _ if rest.starts_with("/*") => match block_comment(rest) {
                Some(bytes) => (Kind::Comment, bytes),
                None => (Kind::Unclosed, rest.len()),
            },
            _ if first.is_alphabetic() || first == '_' => {
                (Kind::Word, run(rest, |c| c.is_alphanumeric() || c == '_'))
            }
            '.' if rest[1..].starts_with(|c: char| c.is_ascii_digit()) => {
                (Kind::Number, number(rest))
            }
            _ if first.is_ascii_digit() => (Kind::Number, number(rest)),
            _ => (Kind::Symbol, first.len_utf8()),
        };
        let (text, after) = rest.split_at(length);
        found.push(Token { kind, text, line });
        line += text.matches('\n').count() as u32;
        rest = after;
    }
    found
}

/// Length, in bytes, of the text's prefix of characters that belong.
fn run(text: &str, belongs: impl Fn(char) -> bool) -> usize {
    text.find(|c| !belongs(c)).unwrap_or(text.len())
}

/// Bytes of a block comment, which may hold others; `None` if it is not closed.
fn block_comment(text: &str) -> Option<usize> {
    let (mut depth, mut at) = (0, 0);
    while at < text.len() {
        let rest = &text.as_bytes()[at..];
        if rest.starts_with(b"/*") {
            (depth, at) = (depth + 1, at + 2);
        } else if rest.starts_with(b"*/") {
            (depth, at) = (depth - 1, at + 2);
        } else {
            at += 1;
        }
        if depth == 0 {
            return Some(at);
        }
    }
    None
}

/// Bytes of a number, with its exponent and suffix.
fn number(text: &str) -> usize {
    let is_hex = text.starts_with("0x") || text.starts_with("0X");
    let mut before = ' ';
    let end = text.find(|c: char| {
        let is_exponent =
            if is_hex { matches!(before, 'p' | 'P') } else { matches!(before, 'e' | 'E') };
        let belongs =
            c.is_ascii_alphanumeric() || c == '.' || (is_exponent && matches!(c, '+' | '-'));
        before = c;
        !belongs
    });
    end.unwrap_or(text.len())
}
