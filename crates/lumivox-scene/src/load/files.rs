//! The files that a scene names: data URIs, and files in the scene's own folder.
//!
//! A scene can come from anywhere, so it must not make this program read other parts of the disk.
//! Unless the user allows more, only relative paths that go down are accepted, and only to files
//! whose real path, with all links resolved, is in the scene's folder as well. Links that stay
//! inside are accepted, and so is a link to the folder itself.

use std::borrow::Cow;
use std::io;
use std::path::{Path, PathBuf};

use super::find::find;
use super::source::{self, FileSource};
use crate::{SceneError, check_regular, read_regular};

/// The files that a scene may name, and their source.
#[derive(Clone, Copy)]
pub(super) struct Reach<'a> {
    /// `true` if any file may be read; otherwise only files in `folders` and below.
    pub(super) anywhere: bool,
    /// The scene's own folder, and for some formats a second one.
    pub(super) folders: &'a [PathBuf],
    /// The source that replaces the disk; `None` for the disk.
    pub(super) source: Option<&'a dyn FileSource>,
}

impl<'a> Reach<'a> {
    /// Reads a regular file; a pipe or a device might never end.
    pub(super) fn read(self, path: &Path) -> io::Result<Cow<'a, [u8]>> {
        match self.source {
            Some(source) => source.read(&source::key(path)),
            None => read_regular(path).map(Cow::Owned),
        }
    }

    pub(super) fn is_file(self, path: &Path) -> bool {
        match self.source {
            Some(source) => source.read(&source::key(path)).is_ok(),
            None => path.is_file(),
        }
    }

    /// The reason why a path of the disk is not a regular file; `None` if it is one, or does not
    /// exist.
    pub(super) fn obstacle(self, path: &Path) -> Option<io::Error> {
        let fault = if self.source.is_some() { None } else { check_regular(path).err() };
        fault.filter(|error| error.kind() != io::ErrorKind::NotFound)
    }

    /// Checks that a file named by a scene may be read: links must not lead out of the folders.
    pub(super) fn admit(self, path: &Path) -> Result<(), String> {
        if self.anywhere || self.source.is_some() {
            return Ok(());
        }
        let real = match path.canonicalize() {
            Ok(real) => real,
            // Reading the file will report the error.
            Err(error) if error.kind() == io::ErrorKind::NotFound => return Ok(()),
            Err(error) => return Err(format!("its real place is not known: {error}")),
        };
        let mut folders = self.folders.iter().filter_map(|folder| folder.canonicalize().ok());
        if folders.any(|folder| real.starts_with(folder)) {
            return Ok(());
        }
        Err(format!("a link leads out of the scene's folder, to {}", real.display()))
    }
}

/// The folder of a file.
pub(super) fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

/// The target of a URI.
pub(super) enum Located {
    /// The bytes of a data URI.
    Data(Vec<u8>),
    /// A file, which may or may not exist.
    File(PathBuf),
}

/// Resolves `uri`, named by `part` of the scene in `file`, without reading a file (RFC 3986:
/// percent signs escape). The first candidate that exists is used, because some files are really
/// called `a%20b.png`, and some URIs are paths of other systems.
pub(super) fn locate_uri(
    file: &Path,
    part: &str,
    uri: &str,
    reach: Reach<'_>,
) -> Result<Located, SceneError> {
    if let Some((scheme, data)) = uri.split_once(':')
        && scheme.eq_ignore_ascii_case("data")
    {
        return decode_data(data).map(Located::Data).map_err(|reason| SceneError::Malformed {
            file: file.to_owned(),
            part: format!("{part}, its data URI,"),
            reason,
        });
    }
    let decoded = String::from_utf8(decode_percent(uri)).unwrap_or_else(|_| uri.to_owned());
    let exact =
        resolve(file, &decoded, reach.anywhere).and_then(|path| reach.admit(&path).map(|()| path));
    if !exact.as_ref().is_ok_and(|path| reach.is_file(path)) {
        // The last candidate is the path without a query or a fragment.
        let path = decoded.split(['?', '#']).next().unwrap_or_default();
        let mut names = [decoded.as_str(), uri, path].into_iter();
        if let Some(found) = names.find_map(|name| find(&[file], name.as_bytes(), reach).ok()) {
            return Ok(Located::File(found));
        }
    }
    exact.map(Located::File).map_err(|reason| SceneError::RefusedUri {
        file: file.to_owned(),
        part: part.to_owned(),
        uri: shorten(&decoded),
        reason,
    })
}

/// Reads the target of `uri`, named by `part` of the scene in `file`.
pub(super) fn read_uri(
    file: &Path,
    part: &str,
    uri: &str,
    reach: Reach<'_>,
) -> Result<Vec<u8>, SceneError> {
    match locate_uri(file, part, uri, reach)? {
        Located::Data(bytes) => Ok(bytes),
        Located::File(path) => {
            reach.read(&path).map(Cow::into_owned).map_err(|source| SceneError::ReadExternal {
                file: file.to_owned(),
                part: part.to_owned(),
                missing: path,
                source,
            })
        }
    }
}

/// The path that `path`, named by `file`, refers to; the error says why it must not be read.
pub(super) fn resolve(file: &Path, path: &str, anywhere: bool) -> Result<PathBuf, String> {
    let checked = check_path(path, anywhere)?;
    Ok(file.parent().unwrap_or(Path::new("")).join(checked))
}

/// Shortens a text that may be long.
pub(crate) fn shorten(text: &str) -> String {
    const LONGEST: usize = 80;
    if text.chars().count() <= LONGEST {
        return text.to_owned();
    }
    text.chars().take(LONGEST).chain("...".chars()).collect()
}

fn check_path(path: &str, anywhere: bool) -> Result<PathBuf, String> {
    if path.is_empty() {
        return Err("the path is empty".to_owned());
    }
    if path.contains('\0') {
        return Err("the path contains a zero byte".to_owned());
    }
    if !anywhere {
        // This also catches Windows' drives.
        if let Some((scheme, _)) = path.split_once(':') {
            return Err(format!("the scheme \"{}:\" is not followed", shorten(scheme)));
        }
        // Both separators count on every system, so that a scene may read the same files
        // everywhere.
        if path.starts_with(['/', '\\']) {
            return Err("the path is absolute".to_owned());
        }
    }
    // Files made on Windows separate folders by backslashes.
    let mut words: Vec<&str> = Vec::new();
    for (i, word) in path.split(['/', '\\']).enumerate() {
        match word {
            "." => {}
            "" if i > 0 => {}
            ".." if words.last().is_some_and(|last| !["", ".."].contains(last)) => {
                words.pop();
            }
            ".." if !anywhere => return Err("the path leaves the scene's folder".to_owned()),
            word => words.push(word),
        }
    }
    Ok(PathBuf::from(words.join("/")))
}

/// Replaces `%41` by `A` and so on (RFC 3986, section 2.1). A percent sign without two hexadecimal
/// digits is not changed.
pub(super) fn decode_percent(text: &str) -> Vec<u8> {
    let text = text.as_bytes();
    let digit = |at: usize| text.get(at).and_then(|&byte| char::from(byte).to_digit(16));
    let mut bytes = Vec::with_capacity(text.len());
    let mut at = 0;
    while at < text.len() {
        let escaped = digit(at + 1).zip(digit(at + 2)).filter(|_| text[at] == b'%');
        bytes.push(escaped.map_or(text[at], |(high, low)| (high * 16 + low) as u8));
        at += if escaped.is_some() { 3 } else { 1 };
    }
    bytes
}

/// The bytes of `[<media type>][;base64],<data>` (RFC 2397).
fn decode_data(data: &str) -> Result<Vec<u8>, String> {
    let Some((head, body)) = data.split_once(',') else {
        return Err("there is no comma before the data".to_owned());
    };
    let body = decode_percent(body);
    let is_base64 = |word: &str| word.trim().eq_ignore_ascii_case("base64");
    if head.split(';').skip(1).any(is_base64) { decode_base64(body) } else { Ok(body) }
}

/// Base64 of RFC 4648, sections 4 and 5; padding may be missing, and lines may be broken.
fn decode_base64(mut digits: Vec<u8>) -> Result<Vec<u8>, String> {
    digits.retain(|digit| !digit.is_ascii_whitespace());
    let end = digits.iter().rposition(|&digit| digit != b'=').map_or(0, |last| last + 1);
    let digits = &digits[..end];
    if digits.len() % 4 == 1 {
        return Err("the base64 text ends in the middle of a byte".to_owned());
    }
    let mut bytes = Vec::with_capacity(digits.len() / 4 * 3 + 2);
    for group in digits.chunks(4) {
        let mut bits = 0_u32;
        for (i, &digit) in group.iter().enumerate() {
            let value = match digit {
                b'A'..=b'Z' => digit - b'A',
                b'a'..=b'z' => digit - b'a' + 26,
                b'0'..=b'9' => digit - b'0' + 52,
                b'+' | b'-' => 62,
                b'/' | b'_' => 63,
                _ => return Err(format!("{:?} is not a base64 digit", char::from(digit))),
            };
            bits |= u32::from(value) << (18 - 6 * i);
        }
        // Four digits are three bytes, three are two, two are one.
        let [_, a, b, c] = bits.to_be_bytes();
        bytes.extend(&[a, b, c][..group.len() - 1]);
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn base64_decodes_the_rfc_4648_vectors() {
        // RFC 4648, section 10.
        for (text, plain) in
            [("", ""), ("Zg==", "f"), ("Zm8=", "fo"), ("Zm9v", "foo"), ("Zm9vYmE=", "fooba")]
        {
            assert_eq!(decode_base64(text.into()).unwrap(), plain.as_bytes());
        }
        assert_eq!(decode_base64("Zg".into()).unwrap(), b"f");
        assert_eq!(decode_base64("Zm\r\n 9v=\n".into()).unwrap(), b"foo");
        assert_eq!(decode_base64("-_-_".into()), decode_base64("+/+/".into()));
        assert!(decode_base64("Z".into()).is_err());
        assert!(decode_base64("Zm9*".into()).is_err());
    }

    #[test]
    fn paths_stay_in_the_folder() {
        let relative_path =
            |uri: &str| check_path(&String::from_utf8(decode_percent(uri)).unwrap(), false);
        assert_eq!(relative_path("a/b%20c.png").unwrap(), PathBuf::from("a/b c.png"));
        assert_eq!(relative_path("./a..b.bin").unwrap(), PathBuf::from("a..b.bin"));
        assert_eq!(relative_path("./a/..\\b//../c.png").unwrap(), PathBuf::from("c.png"));
        for literal in ["50%.png", "a%4", "a%zz", "%"] {
            assert_eq!(relative_path(literal).unwrap(), PathBuf::from(literal));
        }
        for bad in [
            "",
            "../a.bin",
            "a/../../b",
            "a\\..\\..\\b",
            "/etc/passwd",
            "\\\\server\\share",
            "%2e%2e/a.bin",
            "%2Fetc/passwd",
            "http://example.org/a.bin",
            "file:///etc/passwd",
            "C:\\a.bin",
            "a%00b",
        ] {
            assert!(relative_path(bad).is_err(), "{bad}");
        }
        assert_eq!(relative_path("a\\b.png").unwrap(), PathBuf::from("a/b.png"));
        assert!(check_path("../a.bin", true).is_ok());
        assert!(check_path("/a/b.bin", true).is_ok());
        assert!(check_path("", true).is_err());
    }

    #[test]
    fn data_is_base64_or_escaped() {
        for data in [
            "application/octet-stream;base64,AAEC",
            ";base64,AAEC",
            "a/b;charset=x; BASE64,AA%45%43",
            ",%00%01%02",
        ] {
            assert_eq!(decode_data(data).unwrap(), [0, 1, 2], "{data}");
        }
        assert_eq!(decode_data("text/plain,hello").unwrap(), b"hello");
        assert!(decode_data("application/octet-stream;base64").is_err());
    }
}
