//! Lines and numbers of text formats; files may have any encoding, or none.

use std::io::{BufRead, ErrorKind};
use std::path::Path;
use std::str::FromStr;

use super::files::shorten;
use crate::SceneError;

/// The longest line in bytes, joined lines included: a polygon of millions of corners. Without a
/// limit, a file of another format without line breaks would be held in memory.
const LONGEST_LINE: usize = 64 << 20;

/// The lines of a file, ended by LF, CR LF or CR.
pub(super) struct Lines<'f, R> {
    file: &'f Path,
    reader: R,
    line: Vec<u8>,
    number: u64,
    after_return: bool,
    /// `true` if the text is UTF-16, in which ASCII characters are a byte and a zero.
    is_wide: bool,
}

/// The byte order marks of UTF-8, and of UTF-16 in both byte orders.
pub(super) const MARKS: [&[u8]; 3] = [b"\xef\xbb\xbf", b"\xff\xfe", b"\xfe\xff"];

/// Removes the byte order mark of a text; also returns whether the text is UTF-16.
pub(super) fn without_mark(text: &[u8]) -> (&[u8], bool) {
    let marked = |mark: &[u8]| Some((text.strip_prefix(mark)?, mark.len() == 2));
    MARKS.into_iter().find_map(marked).unwrap_or((text, false))
}

impl<'f, R: BufRead> Lines<'f, R> {
    /// The lines of the rest of `file`, from `reader`; `before` lines were read already.
    pub(super) fn new(file: &'f Path, reader: R, before: u64) -> Self {
        Self { file, reader, line: Vec::new(), number: before, after_return: false, is_wide: false }
    }

    /// Reads the next line; `false` at the end of the file.
    pub(super) fn advance(&mut self) -> Result<bool, SceneError> {
        self.line.clear();
        let is_first = self.number == 0;
        let more = self.append()?;
        if is_first {
            let (text, is_wide) = without_mark(&self.line);
            self.is_wide = is_wide;
            self.line.drain(..self.line.len() - text.len());
        }
        self.drop_zeros();
        Ok(more)
    }

    fn drop_zeros(&mut self) {
        if self.is_wide {
            self.line.retain(|&byte| byte != 0);
        }
    }

    /// Reads the next line, joined with the one after it if it ends in a backslash.
    pub(super) fn advance_joined(&mut self) -> Result<bool, SceneError> {
        let more = self.advance()?;
        // A backslash at the end of a comment does not join lines.
        if self.line.trim_ascii_start().starts_with(b"#") {
            return Ok(more);
        }
        // Ignores invisible blanks after the backslash.
        while let Some(before) = self.line.trim_ascii_end().strip_suffix(b"\\") {
            self.line.truncate(before.len());
            self.line.push(b' ');
            if !self.append()? {
                break;
            }
            self.drop_zeros();
        }
        Ok(more)
    }

    /// The line that was read last.
    pub(super) fn line(&self) -> &[u8] {
        &self.line
    }

    /// The error of a line that breaks the format.
    pub(super) fn malformed(&self, reason: impl Into<String>) -> SceneError {
        SceneError::Malformed {
            file: self.file.to_owned(),
            part: format!("line {}", self.number),
            reason: reason.into(),
        }
    }

    /// The number of the line that was read last, from 1.
    pub(super) fn number(&self) -> u64 {
        self.number
    }

    fn append(&mut self) -> Result<bool, SceneError> {
        let mut any = false;
        loop {
            let chunk = match self.reader.fill_buf() {
                Ok(chunk) => chunk,
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(source) => {
                    return Err(SceneError::Read { file: self.file.to_owned(), source });
                }
            };
            let Some(&first) = chunk.first() else {
                self.number += u64::from(any);
                return Ok(any);
            };
            // The zero between the CR and the LF of UTF-16.
            if self.after_return && self.is_wide && first == 0 {
                self.reader.consume(1);
                continue;
            }
            // The second half of a CR LF.
            if std::mem::take(&mut self.after_return) && first == b'\n' {
                self.reader.consume(1);
                continue;
            }
            any = true;
            let end = chunk.iter().position(|&byte| byte == b'\n' || byte == b'\r');
            let length = end.unwrap_or(chunk.len());
            if self.line.len() + length > LONGEST_LINE {
                self.number += 1;
                return Err(self.malformed(format!(
                    "it is longer than {} MiB, so this is hardly a text file",
                    LONGEST_LINE >> 20
                )));
            }
            self.line.extend_from_slice(&chunk[..length]);
            match end {
                Some(end) => {
                    self.after_return = chunk[end] == b'\r';
                    self.number += 1;
                    self.reader.consume(end + 1);
                    return Ok(true);
                }
                None => self.reader.consume(length),
            }
        }
    }
}

/// The words of a line up to a comment. The `#` in `1.#QNAN` does not begin one.
pub(super) fn words(line: &[u8]) -> impl Iterator<Item = &[u8]> {
    let begins = |(at, &byte): (usize, &u8)| byte == b'#' && (at == 0 || line[at - 1] != b'.');
    let end = line.iter().enumerate().position(begins).unwrap_or(line.len());
    line[..end].split(u8::is_ascii_whitespace).filter(|word| !word.is_empty())
}

/// A line's first word, and the rest without the spaces around it.
pub(super) fn keyword(line: &[u8]) -> (&[u8], &[u8]) {
    let line = line.trim_ascii();
    let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
    (&line[..end], line[end..].trim_ascii_start())
}

/// A number; infinities and NaN are read as such, in all spellings of common C libraries
/// (`nan(ind)`, `1.#QNAN`).
pub(super) fn number<T: FromStr + From<f32>>(word: &[u8]) -> Option<T> {
    let text = std::str::from_utf8(word).ok()?;
    if let Ok(number) = text.parse() {
        return Some(number);
    }
    let digits = text.trim_start_matches(['+', '-']).to_ascii_lowercase();
    (digits.starts_with("nan(") || digits.starts_with("1.#")).then_some(f32::NAN.into())
}

/// The next `N` numbers of a line, or a sentence about the fault.
pub(super) fn numbers<'w, const N: usize, T: FromStr + From<f32> + Copy>(
    words: &mut impl Iterator<Item = &'w [u8]>,
) -> Result<[T; N], String> {
    let mut values = [T::from(0.0); N];
    for (i, value) in values.iter_mut().enumerate() {
        let Some(word) = words.next() else {
            return Err(format!("it has {i} numbers instead of {N}"));
        };
        *value = number(word).ok_or_else(|| format!("\"{}\" is not a number", readable(word)))?;
    }
    Ok(values)
}

/// Text of any encoding in printable form, shortened.
pub(super) fn readable(bytes: &[u8]) -> String {
    // Longer texts are shortened anyway; a character has at most four bytes.
    shorten(&String::from_utf8_lossy(&bytes[..bytes.len().min(1024)]))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all(text: &str, capacity: usize) -> Vec<(u64, String)> {
        let reader = std::io::BufReader::with_capacity(capacity, text.as_bytes());
        let mut lines = Lines::new(Path::new("text"), reader, 0);
        let mut all = Vec::new();
        while lines.advance_joined().unwrap() {
            all.push((lines.number(), String::from_utf8(lines.line().to_vec()).unwrap()));
        }
        all
    }

    #[test]
    fn lines_end_with_lf_crlf_or_cr() {
        for capacity in [1, 2, 3, 100] {
            for ending in ["\n", "\r\n", "\r"] {
                let text = ["one", "", "two \\ \t", " three", "# four \\", "five\\"].join(ending);
                let lines = all(&text, capacity);
                let texts: Vec<_> = lines.iter().map(|(_, text)| text.as_str()).collect();
                assert_eq!(texts, ["one", "", "two   three", "# four \\", "five "], "{ending:?}");
                let numbers: Vec<_> = lines.iter().map(|(number, _)| *number).collect();
                assert_eq!(numbers, [1, 2, 4, 5, 6], "{ending:?}");
            }
        }
        assert!(all("", 8).is_empty());
        assert_eq!(all("\r\n", 8), [(1, String::new())]);
    }

    #[test]
    fn byte_order_marks_are_not_part_of_the_text() {
        let wide = |bytes: fn(u16) -> [u8; 2]| -> Vec<u8> {
            "\u{feff}v 1\r\nv 2".encode_utf16().flat_map(bytes).collect()
        };
        for text in
            ["\u{feff}v 1\nv 2".as_bytes(), &wide(u16::to_le_bytes), &wide(u16::to_be_bytes)]
        {
            let mut lines = Lines::new(Path::new("text"), text, 0);
            let mut read = Vec::new();
            while lines.advance_joined().unwrap() {
                read.push(lines.line().to_vec());
            }
            read.retain(|line| !line.is_empty());
            assert_eq!(read, [b"v 1", b"v 2"]);
        }
    }

    #[test]
    fn endless_lines_are_refused() {
        let endless = std::io::BufReader::new(std::io::Read::take(std::io::repeat(b'x'), 1 << 30));
        let mut lines = Lines::new(Path::new("text"), endless, 0);
        let error = lines.advance().unwrap_err().to_string();
        assert!(error.contains("text: line 1 ") && error.contains("64 MiB"), "{error}");
    }

    #[test]
    fn numbers_are_parsed_in_many_spellings() {
        assert_eq!(number(b"-1.5e2"), Some(-150.0));
        assert_eq!(number(b".5"), Some(0.5));
        assert_eq!(number(b"5."), Some(5.0));
        assert_eq!(number(b"1e999"), Some(f32::INFINITY));
        for word in ["nan", "NaN", "-nan", "-nan(ind)", "1.#QNAN", "-1.#IND"] {
            assert!(number::<f32>(word.as_bytes()).unwrap().is_nan(), "{word}");
        }
        for word in ["", "x", "1,5", "0x10", "1.0f", "1#"] {
            assert_eq!(number::<f32>(word.as_bytes()), None, "{word}");
        }
        assert_eq!(numbers::<2, f32>(&mut words(b" 1\t2 3")), Ok([1.0, 2.0]));
        assert!(numbers::<2, f32>(&mut words(b"1")).is_err());
        assert_eq!(words(b"1 1.#IND 2# 3").count(), 3);
        assert_eq!(keyword(b"  usemtl \t a b \r"), (&b"usemtl"[..], &b"a b"[..]));
    }
}
