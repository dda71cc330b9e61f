//! The header of a PLY file: its encoding, and its elements.

use std::io::{BufRead, ErrorKind};
use std::path::Path;

use crate::SceneError;
use crate::load::text::{keyword, readable, without_mark, words};

/// The most bytes of a header: a thousand times as many as real ones have.
const LONGEST: usize = 1 << 20;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Encoding {
    Ascii,
    LittleEndian,
    BigEndian,
}

#[derive(Debug)]
pub(super) struct Header {
    pub(super) encoding: Encoding,
    pub(super) elements: Vec<Element>,
    /// The image that a comment of `MeshLab` names.
    pub(super) texture: Option<String>,
    /// The number of lines of the header.
    pub(super) lines: u64,
}

#[derive(Debug)]
pub(super) struct Element {
    pub(super) name: String,
    pub(super) count: u64,
    pub(super) properties: Vec<Property>,
}

#[derive(Debug)]
pub(super) struct Property {
    pub(super) name: String,
    /// The type of the value, or of a list's items.
    pub(super) scalar: Scalar,
    /// For lists, the type of their lengths.
    pub(super) list_count: Option<Scalar>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Scalar {
    I8,
    U8,
    I16,
    U16,
    I32,
    U32,
    F32,
    F64,
}

impl Scalar {
    /// Accepts both standard spellings, and those of libraries.
    fn parse(word: &[u8]) -> Option<Self> {
        Some(match word {
            b"char" | b"int8" => Self::I8,
            b"uchar" | b"uint8" => Self::U8,
            b"short" | b"int16" => Self::I16,
            b"ushort" | b"uint16" => Self::U16,
            b"int" | b"int32" => Self::I32,
            b"uint" | b"uint32" => Self::U32,
            b"float" | b"float32" => Self::F32,
            b"double" | b"float64" => Self::F64,
            _ => return None,
        })
    }

    pub(super) fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::I32 | Self::U32 | Self::F32 => 4,
            Self::F64 => 8,
        }
    }

    /// The largest value of an integer; `None` for floats.
    pub(super) fn largest(self) -> Option<u32> {
        Some(match self {
            Self::I8 => i8::MAX as u32,
            Self::U8 => u8::MAX.into(),
            Self::I16 => i16::MAX as u32,
            Self::U16 => u16::MAX.into(),
            Self::I32 => i32::MAX as u32,
            Self::U32 => u32::MAX,
            Self::F32 | Self::F64 => return None,
        })
    }
}

impl Element {
    /// The fewest bytes that an entry takes in the file.
    pub(super) fn least_bytes(&self, encoding: Encoding) -> u64 {
        let bytes = |p: &Property| match encoding {
            // A digit and a space.
            Encoding::Ascii => 2,
            _ => p.list_count.unwrap_or(p.scalar).bytes() as u64,
        };
        self.properties.iter().map(bytes).sum()
    }
}

impl Header {
    /// Reads a header, and returns its length in bytes.
    pub(super) fn read(file: &Path, reader: &mut impl BufRead) -> Result<(Self, u64), SceneError> {
        let mut lines = HeadLines { file, reader, line: Vec::new(), bytes: 0, number: 0, cr: None };
        lines.advance()?;
        if without_mark(&lines.line).0.trim_ascii() != b"ply" {
            return Err(lines.malformed("the file does not begin with \"ply\"".to_owned()));
        }
        let mut encoding = None;
        let mut texture = None;
        let mut elements: Vec<Element> = Vec::new();
        loop {
            lines.advance()?;
            let (first, rest) = keyword(&lines.line);
            let fault = match first {
                b"end_header" => break,
                b"comment" if keyword(rest).0 == b"TextureFile" => {
                    texture = Some(readable(keyword(rest).1));
                    Ok(())
                }
                b"comment" | b"obj_info" | b"" => Ok(()),
                b"format" => parse_encoding(rest).map(|parsed| encoding = Some(parsed)),
                b"element" => parse_element(rest).map(|element| elements.push(element)),
                b"property" => match elements.last_mut() {
                    Some(element) => {
                        parse_property(rest).map(|property| element.properties.push(property))
                    }
                    None => Err("a property comes before the first element".to_owned()),
                },
                other => Err(format!("\"{}\" is not a word of a header", readable(other))),
            };
            fault.map_err(|reason| lines.malformed(reason))?;
        }
        let Some(encoding) = encoding else {
            return Err(lines.malformed("the header has no \"format\"".to_owned()));
        };
        Ok((Self { encoding, elements, texture, lines: lines.number }, lines.bytes as u64))
    }
}

fn parse_encoding(rest: &[u8]) -> Result<Encoding, String> {
    match words(rest).next() {
        Some(b"ascii") => Ok(Encoding::Ascii),
        Some(b"binary_little_endian") => Ok(Encoding::LittleEndian),
        Some(b"binary_big_endian") => Ok(Encoding::BigEndian),
        other => Err(format!("the format \"{}\" is unknown", readable(other.unwrap_or_default()))),
    }
}

fn parse_element(rest: &[u8]) -> Result<Element, String> {
    let mut words = words(rest);
    let (Some(name), Some(count)) = (words.next(), words.next()) else {
        return Err("an element needs a name and a count".to_owned());
    };
    let number = std::str::from_utf8(count).ok().and_then(|count| count.parse().ok());
    let count = number.ok_or_else(|| format!("\"{}\" is not a count", readable(count)))?;
    Ok(Element { name: readable(name).to_ascii_lowercase(), count, properties: Vec::new() })
}

fn parse_property(rest: &[u8]) -> Result<Property, String> {
    let mut words = words(rest).peekable();
    let scalar = |words: &mut dyn Iterator<Item = &[u8]>| {
        let word = words.next().unwrap_or_default();
        Scalar::parse(&word.to_ascii_lowercase())
            .ok_or_else(|| format!("\"{}\" is not a type", readable(word)))
    };
    let list_count = match words.next_if_eq(&&b"list"[..]) {
        Some(_) => Some(scalar(&mut words)?),
        None => None,
    };
    if list_count.is_some_and(|count| count.largest().is_none()) {
        return Err("the length of a list is not a whole number".to_owned());
    }
    let scalar = scalar(&mut words)?;
    let name = words.next().ok_or("a property has no name")?;
    Ok(Property { name: readable(name).to_ascii_lowercase(), scalar, list_count })
}

/// Reads only the lines of the header: the next byte may be anything.
struct HeadLines<'a, R> {
    file: &'a Path,
    reader: &'a mut R,
    line: Vec<u8>,
    bytes: usize,
    number: u64,
    /// `true` if lines end in CR only; `None` before the first line, which decides. If `true`, an
    /// LF may be the first byte of the body.
    cr: Option<bool>,
}

impl<R: BufRead> HeadLines<'_, R> {
    fn advance(&mut self) -> Result<(), SceneError> {
        self.line.clear();
        self.number += 1;
        loop {
            match self.next()? {
                b'\n' => return Ok(()),
                b'\r' => {
                    let line_feed = self.peek()? == b'\n';
                    if !*self.cr.get_or_insert(!line_feed) && line_feed {
                        self.next()?;
                    }
                    return Ok(());
                }
                byte => self.line.push(byte),
            }
            if self.bytes > LONGEST {
                return Err(self.malformed(format!("the header is longer than {LONGEST} bytes")));
            }
        }
    }

    fn peek(&mut self) -> Result<u8, SceneError> {
        loop {
            return match self.reader.fill_buf() {
                Ok(&[byte, ..]) => Ok(byte),
                Ok([]) => Err(self.malformed("the file ends within the header".to_owned())),
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(source) => Err(SceneError::Read { file: self.file.to_owned(), source }),
            };
        }
    }

    fn next(&mut self) -> Result<u8, SceneError> {
        let byte = self.peek()?;
        self.reader.consume(1);
        self.bytes += 1;
        Ok(byte)
    }

    fn malformed(&self, reason: String) -> SceneError {
        SceneError::Malformed {
            file: self.file.to_owned(),
            part: format!("line {}", self.number),
            reason,
        }
    }
}
