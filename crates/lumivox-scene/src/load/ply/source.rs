//! The values of a PLY file's body, one by one, from text or bytes.

use std::io::{BufRead, ErrorKind, Read};
use std::path::Path;

use super::header::Scalar;
use crate::SceneError;
use crate::load::text::{Lines, readable};

/// A source of values. All types fit into an f64 without loss.
pub(super) trait Source {
    /// Starts the next element.
    fn begin(&mut self) -> Result<(), SceneError>;

    /// The next value of the element.
    fn value(&mut self, scalar: Scalar) -> Result<f64, SceneError>;

    /// The number of lines or bytes after the last element, in words; `None` if there are none.
    fn rest(&mut self) -> Result<Option<String>, SceneError>;
}

/// Reads elements as lines of numbers.
pub(super) struct Text<'f, R> {
    file: &'f Path,
    /// `true` if each element begins a line; otherwise line breaks are spaces.
    in_lines: bool,
    lines: Lines<'f, R>,
    /// The number of bytes of the line that were read.
    at: usize,
}

impl<'f, R: BufRead> Text<'f, R> {
    pub(super) fn new(file: &'f Path, reader: R, before: u64, in_lines: bool) -> Self {
        Self { file, in_lines, lines: Lines::new(file, reader, before), at: 0 }
    }

    fn advance(&mut self) -> Result<(), SceneError> {
        self.at = 0;
        if self.lines.advance()? { Ok(()) } else { Err(ends_early(self.file)) }
    }

    /// The range of the line's next word; empty at the end of the line.
    fn word(&mut self) -> std::ops::Range<usize> {
        let line = &self.lines.line()[self.at..];
        let blank = line.iter().take_while(|byte| byte.is_ascii_whitespace()).count();
        let length = line[blank..].iter().take_while(|byte| !byte.is_ascii_whitespace()).count();
        let start = self.at + blank;
        self.at = start + length;
        start..self.at
    }
}

impl<R: BufRead> Source for Text<'_, R> {
    /// Drops surplus words of a line, so that a bad line only spoils one element.
    fn begin(&mut self) -> Result<(), SceneError> {
        if !self.in_lines {
            return Ok(());
        }
        self.advance()?;
        while self.lines.line().trim_ascii().is_empty() {
            self.advance()?;
        }
        Ok(())
    }

    /// Continues on the next line if one is too short: some programs wrap lines.
    fn value(&mut self, _scalar: Scalar) -> Result<f64, SceneError> {
        let mut range = self.word();
        while range.is_empty() {
            self.advance()?;
            range = self.word();
        }
        let word = &self.lines.line()[range];
        let parsed = std::str::from_utf8(word).ok().and_then(|text| text.parse().ok());
        parsed
            .or_else(|| crate::load::text::number(word))
            .ok_or_else(|| self.lines.malformed(format!("\"{}\" is not a number", readable(word))))
    }

    fn rest(&mut self) -> Result<Option<String>, SceneError> {
        let mut count = 0_u64;
        while self.lines.advance()? {
            count += u64::from(!self.lines.line().trim_ascii().is_empty());
        }
        Ok((count > 0).then(|| format!("{count} lines")))
    }
}

/// Reads elements as bytes in big-endian (`BIG`) or little-endian order.
pub(super) struct Binary<'f, R, const BIG: bool> {
    file: &'f Path,
    reader: R,
}

impl<'f, R: Read, const BIG: bool> Binary<'f, R, BIG> {
    pub(super) fn new(file: &'f Path, reader: R) -> Self {
        Self { file, reader }
    }

    /// The next bytes, in little-endian order.
    fn bytes<const N: usize>(&mut self) -> Result<[u8; N], SceneError> {
        let mut bytes = [0; N];
        self.reader.read_exact(&mut bytes).map_err(|source| match source.kind() {
            ErrorKind::UnexpectedEof => ends_early(self.file),
            _ => SceneError::Read { file: self.file.to_owned(), source },
        })?;
        if BIG {
            bytes.reverse();
        }
        Ok(bytes)
    }
}

impl<R: Read, const BIG: bool> Source for Binary<'_, R, BIG> {
    fn begin(&mut self) -> Result<(), SceneError> {
        Ok(())
    }

    fn value(&mut self, scalar: Scalar) -> Result<f64, SceneError> {
        Ok(match scalar {
            Scalar::I8 => f64::from(i8::from_le_bytes(self.bytes()?)),
            Scalar::U8 => f64::from(u8::from_le_bytes(self.bytes()?)),
            Scalar::I16 => f64::from(i16::from_le_bytes(self.bytes()?)),
            Scalar::U16 => f64::from(u16::from_le_bytes(self.bytes()?)),
            Scalar::I32 => f64::from(i32::from_le_bytes(self.bytes()?)),
            Scalar::U32 => f64::from(u32::from_le_bytes(self.bytes()?)),
            Scalar::F32 => f64::from(f32::from_le_bytes(self.bytes()?)),
            Scalar::F64 => f64::from_le_bytes(self.bytes()?),
        })
    }

    fn rest(&mut self) -> Result<Option<String>, SceneError> {
        let count = std::io::copy(&mut self.reader, &mut std::io::sink())
            .map_err(|source| SceneError::Read { file: self.file.to_owned(), source })?;
        // Some programs end the file with a line break.
        Ok((count > 2).then(|| format!("{count} bytes")))
    }
}

fn ends_early(file: &Path) -> SceneError {
    SceneError::Malformed {
        file: file.to_owned(),
        part: "the file".to_owned(),
        reason: "it ends before all that its header declares, so it was cut off".to_owned(),
    }
}
