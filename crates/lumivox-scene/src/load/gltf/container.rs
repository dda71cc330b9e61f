//! The two containers of glTF 2.0, JSON and GLB (section 4.4), parsed to a document with valid
//! indices, and its buffers.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::path::Path;

use gltf::Document;
use gltf::json::validation::{Error as Fault, Validate};
use gltf::json::{Path as JsonPath, Root};

use super::compression::Buffers;
use super::repair::read_root;
use super::{Notes, compression, extensions, name_or_index, version};
use crate::load::LoadOptions;
use crate::load::files::{self, Reach};
use crate::{LoadNotes, SceneError};

const JSON_CHUNK: u32 = u32::from_le_bytes(*b"JSON");
const BINARY_CHUNK: u32 = u32::from_le_bytes(*b"BIN\0");

/// A document whose indices are valid, and the bytes of its buffers.
pub(super) struct Parsed<'a> {
    pub(super) document: Document,
    pub(super) buffers: Buffers<'a>,
    pub(super) json: &'a [u8],
    pub(super) about: LoadNotes,
}

pub(super) fn parse<'a>(
    file: &Path,
    bytes: &'a [u8],
    reach: Reach<'_>,
    options: &LoadOptions<'_>,
    notes: &mut Notes,
) -> Result<Parsed<'a>, SceneError> {
    let malformed = |part: &str, reason: String| SceneError::Malformed {
        file: file.to_owned(),
        part: part.to_owned(),
        reason,
    };
    if bytes.is_empty() {
        return Err(malformed("the file", "it is empty".to_owned()));
    }
    let (json, binary) = if bytes.starts_with(b"glTF") {
        if let Some(version) = version::of_container(bytes) {
            return Err(version::unknown(file, version));
        }
        // Some programs write a wrong length.
        let declared = bytes.get(8..12).and_then(|length| length.try_into().ok());
        let length = declared.map_or(0, u32::from_le_bytes) as usize;
        split_glb(bytes.get(..length).unwrap_or(bytes))
            .or_else(|_| split_glb(bytes))
            .map_err(|reason| malformed("the GLB container", reason))?
    } else {
        (bytes, None)
    };
    // Some exporters write a byte order mark, which JSON forbids.
    let json = json.strip_prefix(b"\xef\xbb\xbf").unwrap_or(json);
    // Other exporters pad it with zeros.
    let end = json.iter().rposition(|&byte| byte != 0).map_or(0, |last| last + 1);
    let json = &json[..end];
    let root = read_root(json, notes);
    if let Some(version) = version::of_document(json, root.as_ref().ok()) {
        return Err(version::unknown(file, version));
    }
    let mut root = root.map_err(|error| {
        malformed("the JSON", super::json::what(json).unwrap_or_else(|| error.to_string()))
    })?;
    let about = super::about::about(&root);

    extensions::check(file, &mut root, options.ignore_required, notes)?;
    drop_primitives_without_positions(&mut root, notes);
    check_position_indices(&root).map_err(|(part, reason)| malformed(&part, reason))?;
    check_indices(&mut root, notes).map_err(|(part, reason)| malformed(&part, reason))?;
    let mut buffers = read_buffers(file, &root, binary, reach)?;
    compression::decompress(file, &mut root, &mut buffers, options.budget.geometry_bytes)?;
    let document = Document::from_json_without_validation(root);
    Ok(Parsed { document, buffers, json, about })
}

/// Splits a GLB into the JSON and the binary chunk. Lengths are checked against the bytes that
/// exist.
fn split_glb(bytes: &[u8]) -> Result<(&[u8], Option<&[u8]>), String> {
    let word = |at: usize| -> Result<u32, String> {
        let bytes = bytes.get(at..at + 4).ok_or("it ends in the middle of a header")?;
        Ok(u32::from_le_bytes([bytes[0], bytes[1], bytes[2], bytes[3]]))
    };
    let length = bytes.len();
    let mut at = 12;
    let mut chunk = || -> Result<Option<(&[u8], u32)>, String> {
        if at >= length {
            return Ok(None);
        }
        let size = word(at)? as usize;
        let kind = word(at + 4)?;
        let begin = at + 8;
        // This form does not overflow if usize has 32 bits.
        if begin > length || size > length - begin {
            return Err(format!(
                "a chunk of {size} bytes at byte {at} does not fit in its {length} bytes, so it was \
                 cut off"
            ));
        }
        at = begin + size.next_multiple_of(4).min(length - begin);
        // Some programs omit the padding: the next chunk then begins immediately.
        let behind = begin + size;
        if at != behind && word(behind + 4) == Ok(BINARY_CHUNK) {
            at = behind;
        }
        Ok(Some((&bytes[begin..begin + size], kind)))
    };

    let json = match chunk()? {
        Some((json, JSON_CHUNK)) => json,
        Some(_) => return Err("its first chunk is not JSON".to_owned()),
        None => return Err("it ends behind its header, so it was cut off".to_owned()),
    };
    // Unknown chunks after the first must be ignored.
    while let Some((data, kind)) = chunk()? {
        if kind == BINARY_CHUNK {
            return Ok((json, Some(data)));
        }
    }
    Ok((json, None))
}

fn drop_primitives_without_positions(root: &mut Root, notes: &mut Notes) {
    use gltf::json::validation::Checked::Valid;
    for (i, mesh) in root.meshes.iter_mut().enumerate() {
        let before = mesh.primitives.len();
        mesh.primitives.retain(|primitive| {
            primitive.attributes.contains_key(&Valid(gltf::Semantic::Positions))
        });
        let dropped = before - mesh.primitives.len();
        if dropped > 0 {
            let name = mesh.name.clone().unwrap_or_else(|| i.to_string());
            notes.warn(format!(
                "mesh \"{name}\": {dropped} primitives without positions were skipped"
            ));
        }
    }
}

/// Checks indices that the JSON library's validation would use unchecked.
pub(super) fn check_position_indices(root: &Root) -> Result<(), (String, String)> {
    for (i, mesh) in root.meshes.iter().enumerate() {
        for index in mesh.primitives.iter().flat_map(|primitive| primitive.attributes.values()) {
            if index.value() >= root.accessors.len() {
                let reason = format!(
                    "an attribute names accessor {}, but there are only {}",
                    index.value(),
                    root.accessors.len()
                );
                return Err((format!("mesh {i}"), reason));
            }
        }
    }
    Ok(())
}

/// Checks all references; the rest of the loader relies on it. Broken animations are emptied, so
/// that the others keep their indices.
fn check_indices(root: &mut Root, notes: &mut Notes) -> Result<(), (String, String)> {
    let mut first = None;
    let mut animations: BTreeMap<usize, String> = BTreeMap::new();
    let checked: &Root = root;
    checked.validate(checked, JsonPath::new, &mut |path, fault| {
        let path = path();
        let text = path.as_str();
        // The specification requires bounds of positions, but nothing here needs them.
        let only_bounds =
            text.contains("POSITION") && (text.ends_with("min") || text.ends_with("max"));
        // An accessor without a buffer view, which the library does not support, is all zeros.
        let only_zeros = fault == Fault::Missing
            && text.starts_with("accessors[")
            && text.ends_with(".bufferView");
        // The target is a hint for old drivers, and the stride is checked where it is used.
        let only_hint = text.starts_with("bufferViews[")
            && (text.ends_with(".target") || text.ends_with(".byteStride"));
        // An image without bytes counts as missing when it is read.
        let only_image = text.starts_with("images[") && text.ends_with(".bufferView");
        if !only_bounds && !only_zeros && !only_hint && !only_image {
            let reason = match fault {
                Fault::IndexOutOfBounds => "it points at something that does not exist",
                Fault::Missing => "it is missing",
                Fault::Oversize => "it is larger than memory",
                Fault::Unsupported => "it is not supported",
                Fault::Invalid => "its value is not allowed",
            };
            match animation(text) {
                Some(index) => {
                    animations.entry(index).or_insert_with(|| format!("{text}: {reason}"));
                }
                None => {
                    first.get_or_insert_with(|| (text.to_owned(), reason.to_owned()));
                }
            }
        }
    });
    for (index, reason) in animations {
        let Some(animation) = root.animations.get_mut(index) else { continue };
        let name = name_or_index(animation.name.as_deref(), "animation", index);
        notes.warn(format!("the animation \"{name}\" is malformed and was left out: {reason}"));
        animation.channels.clear();
        animation.samplers.clear();
    }
    // Checks that the library omits.
    for (i, camera) in root.cameras.iter().enumerate() {
        use gltf::json::camera::Type;
        let missing = match camera.type_ {
            gltf::json::validation::Checked::Valid(Type::Perspective) => {
                camera.perspective.is_none()
            }
            _ => camera.orthographic.is_none(),
        };
        if missing && first.is_none() {
            first = Some((format!("camera {i}"), "its projection is missing".to_owned()));
        }
    }
    first.map_or(Ok(()), Err)
}

/// The index of the animation that a path in the document belongs to, such as
/// `animations[3].channels[0]`.
fn animation(place: &str) -> Option<usize> {
    place.strip_prefix("animations[")?.split(']').next()?.parse().ok()
}

fn read_buffers<'a>(
    file: &Path,
    root: &Root,
    binary: Option<&'a [u8]>,
    reach: Reach<'_>,
) -> Result<Buffers<'a>, SceneError> {
    let mut buffers = Buffers::new();
    for (i, buffer) in root.buffers.iter().enumerate() {
        let part = format!("buffer {i}");
        let malformed = |reason: String| SceneError::Malformed {
            file: file.to_owned(),
            part: part.clone(),
            reason,
        };
        if compression::is_stand_in(root, i) {
            buffers.push(Cow::Borrowed(&[]));
            continue;
        }
        let data = match (&buffer.uri, binary) {
            (Some(uri), _) => Cow::Owned(files::read_uri(file, &part, uri, reach)?),
            // Only the first buffer can be the GLB's binary chunk.
            (None, Some(binary)) if i == 0 => Cow::Borrowed(binary),
            (None, _) => return Err(malformed("it has neither a URI nor a GLB chunk".to_owned())),
        };
        // The declared length may include padding that the file does not have; only views must fit.
        buffers.push(data);
    }
    Ok(buffers)
}
