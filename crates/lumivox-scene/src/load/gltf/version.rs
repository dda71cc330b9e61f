//! Distinguishes other versions of glTF from broken files.

use std::path::Path;

use gltf::json::Root;
use serde_json::Value;

use crate::SceneError;
use crate::load::files::shorten;

/// The version of a GLB container, if it is not 2.
pub(super) fn of_container(bytes: &[u8]) -> Option<String> {
    let version = u32::from_le_bytes(*bytes.get(4..)?.first_chunk()?);
    // Version 1 of the container held glTF 1.0.
    (version != 2).then(|| format!("{version}.0"))
}

/// The unsupported version of a document; `root` exists if the document has the form of 2.0.
pub(super) fn of_document(json: &[u8], root: Option<&Root>) -> Option<String> {
    if let Some(root) = root {
        let needed = root.asset.min_version.as_ref().unwrap_or(&root.asset.version);
        return is_other(needed).then(|| shorten(needed));
    }
    let document: Value = serde_json::from_slice(json).ok()?;
    match &document["asset"]["version"] {
        Value::String(version) if is_other(version) => Some(shorten(version)),
        Value::Number(version) if is_other(&version.to_string()) => Some(version.to_string()),
        // glTF 1.0 has objects where 2.0 has arrays, and its files may omit the version.
        Value::Null if document["meshes"].is_object() || document["nodes"].is_object() => {
            Some("1.0".to_owned())
        }
        _ => None,
    }
}

/// Whether a version is certainly not 2.x.
fn is_other(version: &str) -> bool {
    major(version).is_some_and(|major| major != 2)
}

fn major(version: &str) -> Option<u32> {
    version.trim().split('.').next()?.parse().ok()
}

/// The error about an unsupported version.
pub(super) fn unknown(file: &Path, version: String) -> SceneError {
    let is_older = major(&version).is_some_and(|major| major < 2);
    let remedy = if is_older {
        "convert it to 2.0, for instance with `gltf-pipeline -i OLD -o new.glb`"
    } else {
        "export it as glTF 2.0"
    };
    SceneError::Version { file: file.to_owned(), version, remedy }
}
