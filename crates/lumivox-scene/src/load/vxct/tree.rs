//! The syntax tree: names with a value or with a block.
//!
//! ```text
//! block := { NAME '=' VALUE | NAME ['='] '{' block '}' | STRAY }
//! ```
//!
//! A name and a value are any token except the three signs. Other tokens are stray and ignored.

use std::iter::Peekable;
use std::path::Path;

use super::token::{Place, Token, Tokens};
use crate::SceneError;
use crate::load::Notes;
use crate::load::files::shorten;

/// The deepest nesting of blocks; real scenes have four.
const DEEPEST: usize = 32;
/// The most entries of a file: enough for a hundred thousand models, and a bound on memory.
const MOST_ENTRIES: usize = 1 << 20;
/// The most stray tokens that are reported one by one.
const MOST_STRAYS: usize = 20;

/// A name and its value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Entry<'t> {
    pub(super) key: Token<'t>,
    pub(super) value: Value<'t>,
}

/// The value of a name.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Value<'t> {
    Word(Token<'t>),
    Block(Block<'t>),
}

/// The entries between braces; the whole file is a block, too.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Block<'t> {
    /// The place of the opening brace.
    pub(super) at: Place,
    pub(super) entries: Vec<Entry<'t>>,
}

/// The error at a place.
pub(super) fn fault(
    file: &Path,
    at: Place,
    found: impl Into<String>,
    expected: impl Into<String>,
) -> SceneError {
    SceneError::Syntax {
        file: file.to_owned(),
        line: at.line,
        column: at.column,
        found: found.into(),
        expected: expected.into(),
    }
}

/// Quotes a token for a message.
pub(super) fn quote(token: &Token<'_>) -> String {
    // A token may be as long as the file.
    let head = token.text.char_indices().nth(100).map_or(token.text, |(end, _)| &token.text[..end]);
    format!("\"{}\"", shorten(head))
}

/// Reads a whole file's text; also returns the number of stray tokens.
pub(super) fn read<'t>(
    file: &Path,
    text: &'t str,
    notes: &mut Notes,
) -> Result<(Block<'t>, usize), SceneError> {
    let end = {
        let mut tokens = Tokens::new(text);
        while tokens.next().is_some() {}
        tokens.place()
    };
    let tokens = Tokens::new(text).peekable();
    let mut reader = Reader { file, tokens, end, notes, entries: 0, strays: 0 };
    let root = reader.block(None, 0)?;
    let strays = reader.strays;
    if strays > MOST_STRAYS {
        notes.warn(format!("{} more stray tokens were ignored", strays - MOST_STRAYS));
    }
    Ok((root, strays))
}

struct Reader<'r, 't> {
    file: &'r Path,
    tokens: Peekable<Tokens<'t>>,
    end: Place,
    notes: &'r mut Notes,
    entries: usize,
    strays: usize,
}

impl<'t> Reader<'_, 't> {
    /// Reads the entries after the brace `open`, up to the matching brace; without `open`, the
    /// whole file.
    fn block(&mut self, open: Option<Token<'t>>, depth: usize) -> Result<Block<'t>, SceneError> {
        let at = open.map_or(Place { line: 1, column: 1 }, |brace| brace.at);
        if depth > DEEPEST {
            let found = format!("a block within {DEEPEST} others");
            return Err(self.fault(
                at,
                found,
                "no more than `scene { model { material { color { } } } }`",
            ));
        }
        let mut entries = Vec::new();
        loop {
            let Some(token) = self.tokens.next() else {
                return match open {
                    None => Ok(Block { at, entries }),
                    Some(brace) => {
                        let expected = format!("`}}` for the `{{` at {}", brace.at);
                        Err(self.fault(self.end, "the end of the file", expected))
                    }
                };
            };
            match token.text {
                "}" if open.is_some() => return Ok(Block { at, entries }),
                "}" => self.stray(&token, "no block is open there"),
                "{" => {
                    return Err(self.fault(token.at, "`{`", "a name before it, such as `model {`"));
                }
                "=" => {
                    return Err(self.fault(token.at, "`=`", "a name before it, such as `name =`"));
                }
                _ => entries.extend(self.entry(token, depth)?),
            }
        }
    }

    /// The entry that begins with `key`; `None` if the token is not a name.
    fn entry(&mut self, key: Token<'t>, depth: usize) -> Result<Option<Entry<'t>>, SceneError> {
        let after = self.tokens.next_if(|token| matches!(token.text, "=" | "{"));
        let brace = match after {
            None => {
                let hint = if key.text.contains(['=', '{', '}']) {
                    "`=`, `{` and `}` need white space around them"
                } else {
                    "neither `=` nor `{` follows it"
                };
                self.stray(&key, hint);
                return Ok(None);
            }
            Some(sign) if sign.text == "=" => {
                let expected = || format!("a value for {}", quote(&key));
                match self.tokens.next() {
                    None => return Err(self.fault(self.end, "the end of the file", expected())),
                    Some(token) if token.text == "{" => token,
                    Some(token) if token.is_sign() => {
                        return Err(self.fault(token.at, format!("`{}`", token.text), expected()));
                    }
                    Some(word) => {
                        self.count(&key)?;
                        return Ok(Some(Entry { key, value: Value::Word(word) }));
                    }
                }
            }
            Some(brace) => brace,
        };
        self.count(&key)?;
        let block = self.block(Some(brace), depth + 1)?;
        Ok(Some(Entry { key, value: Value::Block(block) }))
    }

    fn count(&mut self, key: &Token<'t>) -> Result<(), SceneError> {
        self.entries += 1;
        if self.entries <= MOST_ENTRIES {
            return Ok(());
        }
        let found = format!("name {} of the file", self.entries);
        Err(self.fault(key.at, found, format!("at most {MOST_ENTRIES}, split the scene")))
    }

    fn stray(&mut self, token: &Token<'t>, why: &str) {
        self.strays += 1;
        if self.strays <= MOST_STRAYS {
            self.notes.warn(format!("{}: {} was ignored: {why}", token.at, quote(token)));
        }
    }

    fn fault(
        &self,
        at: Place,
        found: impl Into<String>,
        expected: impl Into<String>,
    ) -> SceneError {
        fault(self.file, at, found, expected)
    }
}

#[cfg(test)]
#[path = "tree_tests.rs"]
mod tests;
