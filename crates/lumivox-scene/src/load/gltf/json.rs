//! The text of a document: its encoding, and its kind if it is not glTF.

use std::borrow::Cow;

use serde_json::Value;

/// The text in UTF-8: some editors save it as UTF-16, with a mark at its start.
pub(super) fn utf8(bytes: &[u8]) -> Cow<'_, [u8]> {
    let wide = |order: fn([u8; 2]) -> u16| {
        let units: Vec<u16> =
            bytes[2..].chunks_exact(2).map(|pair| order([pair[0], pair[1]])).collect();
        Cow::Owned(String::from_utf16_lossy(&units).into_bytes())
    };
    match bytes {
        [0xff, 0xfe, ..] => wide(u16::from_le_bytes),
        [0xfe, 0xff, ..] => wide(u16::from_be_bytes),
        _ => Cow::Borrowed(bytes),
    }
}

/// The kind of a text that is not glTF, with the remedy; `None` if it is unknown.
pub(super) fn what(json: &[u8]) -> Option<String> {
    if let Some(line) = line_of_comment(json) {
        return Some(format!("line {line} has a comment, which JSON forbids: remove all comments"));
    }
    let document: Value = serde_json::from_slice(json).ok()?;
    let kind = match &document {
        Value::Object(_) => document["metadata"]["type"].as_str()?,
        Value::Array(_) => return Some(not_an_object("a list")),
        _ => return Some(not_an_object("a single value")),
    };
    ["Object", "BufferGeometry", "Geometry", "App"].contains(&kind).then(|| {
        format!(
            "it is JSON of three.js (\"{kind}\"), not glTF: load it there and export it with its \
             GLTFExporter (in its editor: File, Export, GLB)"
        )
    })
}

fn not_an_object(what: &str) -> String {
    format!("it is {what}, but glTF is one object with \"asset\", \"scenes\" and \"meshes\"")
}

/// The line of the first comment, from 1.
fn line_of_comment(json: &[u8]) -> Option<usize> {
    let (mut in_text, mut at) = (false, 0);
    while let Some(&byte) = json.get(at) {
        let rest = &json[at..];
        if !in_text && (rest.starts_with(b"//") || rest.starts_with(b"/*")) {
            return Some(json[..at].split(|&byte| byte == b'\n').count());
        }
        in_text ^= byte == b'"';
        // An escaped character does not end a string.
        at += if in_text && byte == b'\\' { 2 } else { 1 };
    }
    None
}
