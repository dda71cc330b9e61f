//! JSON that follows the specification, but that the JSON library does not take.

use gltf::json::{Error, Root};
use serde_json::Value;

use super::Notes;
use crate::load::files::shorten;

/// Reads the document. Channels that animate something other than nodes (`KHR_animation_pointer`)
/// are taken out, with a warning; so are what morph targets do to other things than positions,
/// normals and tangents.
pub(super) fn read_root(json: &[u8], notes: &mut Notes) -> Result<Root, Error> {
    let root = match Root::from_slice(json) {
        Ok(root) => root,
        Err(error) => {
            let Some(json) = without_pointers(json, notes) else { return Err(error) };
            Root::from_slice(&json)?
        }
    };
    let has_targets = |mesh: &gltf::json::Mesh| mesh.primitives.iter().any(|p| p.targets.is_some());
    if root.meshes.iter().any(has_targets) {
        warn_of_other_targets(json, notes);
    }
    Ok(root)
}

/// The JSON again without channels that name no node, if there are such.
fn without_pointers(json: &[u8], notes: &mut Notes) -> Option<Vec<u8>> {
    let mut value: Value = serde_json::from_slice(json).ok()?;
    let mut dropped = 0;
    for animation in value.get_mut("animations")?.as_array_mut()? {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else {
            continue;
        };
        let before = channels.len();
        channels.retain(|channel| channel.get("target").is_none_or(|t| t.get("node").is_some()));
        dropped += before - channels.len();
    }
    if dropped == 0 {
        return None;
    }
    notes.warn(format!(
        "{dropped} channels of animations move no nodes (KHR_animation_pointer is not supported) \
         and were ignored"
    ));
    serde_json::to_vec(&value).ok()
}

fn warn_of_other_targets(json: &[u8], notes: &mut Notes) {
    let Ok(value) = serde_json::from_slice::<Value>(json) else { return };
    let primitives = list(&value, "meshes").iter().flat_map(|mesh| list(mesh, "primitives"));
    let targets = primitives.flat_map(|primitive| list(primitive, "targets"));
    for other in targets.filter_map(Value::as_object).flat_map(|target| target.keys()) {
        if !["POSITION", "NORMAL", "TANGENT"].contains(&other.as_str()) {
            notes.warn(format!(
                "morph targets move positions, normals and tangents; what they do to {} was ignored",
                shorten(other)
            ));
        }
    }
}

fn list<'a>(value: &'a Value, key: &str) -> &'a [Value] {
    value.get(key).and_then(Value::as_array).map_or(&[], Vec::as_slice)
}
