//! Repairs JSON that the JSON library would refuse.

use std::borrow::Cow;

use gltf::Semantic;
use gltf::json::material::AlphaMode;
use gltf::json::validation::Checked::{self, Invalid, Valid};
use gltf::json::{Error, Root};
use serde_json::{Value, json};

use super::{Notes, dangling, name_or_index};
use crate::load::files::shorten;

/// Reads the document. Removes, with a warning, channels that animate something other than nodes
/// (`KHR_animation_pointer`), malformed animations, numbers that are not finite, and data of morph
/// targets for attributes other than positions, normals and tangents.
pub(super) fn read_root(json: &[u8], notes: &mut Notes) -> Result<Root, Error> {
    let mut json = Cow::Borrowed(json);
    let mut root = match Root::from_slice(&json) {
        Ok(root) => root,
        Err(error) => {
            let Some(repaired) = repaired(&json, notes) else { return Err(error) };
            json = Cow::Owned(repaired);
            Root::from_slice(&json)?
        }
    };
    if let Some(mended) = dangling::mended(&root, &json, notes) {
        json = Cow::Owned(mended);
        root = Root::from_slice(&json)?;
    }
    replace_unknown(&mut root, &json, notes);
    let has_targets = |mesh: &gltf::json::Mesh| mesh.primitives.iter().any(|p| p.targets.is_some());
    if root.meshes.iter().any(has_targets) {
        warn_of_other_targets(&json, notes);
    }
    Ok(root)
}

/// Removes attributes that are not read and empty URIs. Replaces unknown values of samplers and
/// alpha modes by defaults, with a warning.
fn replace_unknown(root: &mut Root, json: &[u8], notes: &mut Notes) {
    for (index, mesh) in root.meshes.iter_mut().enumerate() {
        let mut is_named = true;
        for primitive in &mut mesh.primitives {
            is_named &= !primitive.attributes.contains_key(&Invalid);
            let is_read = |name: &_| !matches!(name, Invalid | Valid(Semantic::Extras(_)));
            primitive.attributes.retain(|name, _| is_read(name));
        }
        if !is_named {
            let name = name_or_index(mesh.name.as_deref(), "mesh", index);
            notes.warn(format!(
                "mesh \"{name}\": attributes with names unknown to glTF were ignored"
            ));
        }
    }
    let buffers = root.buffers.iter_mut().map(|buffer| &mut buffer.uri);
    for uri in buffers.chain(root.images.iter_mut().map(|image| &mut image.uri)) {
        uri.take_if(|uri| uri.is_empty());
    }
    for (index, sampler) in root.samplers.iter_mut().enumerate() {
        let are_unknown = [
            sampler.mag_filter.take_if(|filter| *filter == Invalid).is_some(),
            sampler.min_filter.take_if(|filter| *filter == Invalid).is_some(),
            reset_unknown(&mut sampler.wrap_s),
            reset_unknown(&mut sampler.wrap_t),
        ];
        if are_unknown.contains(&true) {
            notes.warn(format!(
                "sampler {index}: a filter or wrapping mode unknown to glTF was replaced by the \
                 default, linear or repeating"
            ));
        }
    }
    let mut document = None;
    for (index, material) in root.materials.iter_mut().enumerate() {
        if !reset_unknown(&mut material.alpha_mode) {
            continue;
        }
        let document: &Value =
            document.get_or_insert_with(|| serde_json::from_slice(json).unwrap_or_default());
        let given = document["materials"][index]["alphaMode"].as_str().unwrap_or_default();
        let mode = match given.to_ascii_uppercase().as_str() {
            "MASK" => AlphaMode::Mask,
            "BLEND" => AlphaMode::Blend,
            _ => AlphaMode::Opaque,
        };
        notes.warn(format!(
            "material \"{}\": its alphaMode \"{}\" is unknown to glTF and counts as {mode:?}",
            name_or_index(material.name.as_deref(), "material", index),
            shorten(given)
        ));
        material.alpha_mode = Valid(mode);
    }
}

/// Replaces an unknown value by the default; `true` if it was unknown.
fn reset_unknown<T: Default + PartialEq>(value: &mut Checked<T>) -> bool {
    let is_unknown = *value == Invalid;
    if is_unknown {
        *value = Valid(T::default());
    }
    is_unknown
}

/// The JSON in a form that the library accepts; `None` if there is nothing to repair.
fn repaired(json: &[u8], notes: &mut Notes) -> Option<Vec<u8>> {
    let finite = replace_numbers(json);
    let mut document: Value = serde_json::from_slice(&finite).ok()?;
    let is_finite = finite.len() == json.len();
    if !is_finite {
        notes.warn("numbers of its JSON that are not finite became zero".to_owned());
    }
    let are_repaired = [
        !is_finite,
        make_whole(&mut document),
        name_nodes(&mut document),
        drop_pointers(&mut document, notes),
        // After `drop_pointers`, which mends some animations.
        empty_animations(&mut document, notes),
    ];
    are_repaired.contains(&true).then(|| serde_json::to_vec(&document).ok())?
}

/// The JSON with zeros instead of `NaN` and `Infinity`, which Python writes.
fn replace_numbers(json: &[u8]) -> Vec<u8> {
    let mut finite = Vec::with_capacity(json.len());
    let (mut in_text, mut at) = (false, 0);
    while let Some(&byte) = json.get(at) {
        let rest = &json[at..];
        let number = [&b"NaN"[..], b"Infinity", b"-Infinity"]
            .into_iter()
            .find(|number| !in_text && rest.starts_with(number));
        // An escaped character does not end a string.
        let taken = number.map_or(if in_text && byte == b'\\' { 2 } else { 1 }, <[u8]>::len);
        in_text ^= byte == b'"';
        finite.extend(if number.is_some() { b"0" } else { &rest[..taken.min(rest.len())] });
        at += taken;
    }
    finite
}

/// Writes whole numbers as integers: some programs write all numbers as floats, even indices.
fn make_whole(value: &mut Value) -> bool {
    // Floats above this are not exact integers.
    const MOST: f64 = (1_u64 << 53) as f64;
    match value {
        Value::Array(list) => list.iter_mut().fold(false, |any, value| make_whole(value) | any),
        Value::Object(map) => map.values_mut().fold(false, |any, value| make_whole(value) | any),
        Value::Number(number) if number.is_f64() => {
            let float = number.as_f64().filter(|n| n.fract() == 0.0 && (0.0..MOST).contains(n));
            float.inspect(|&float| *value = json!(float as u64)).is_some()
        }
        _ => false,
    }
}

/// Adds missing lists of nodes to scenes: they are optional (glTF 2.0, section 5.27).
fn name_nodes(document: &mut Value) -> bool {
    let mut is_repaired = false;
    for scene in list_mut(document, "scenes").iter_mut().filter_map(Value::as_object_mut) {
        is_repaired |= !scene.contains_key("nodes");
        scene.entry("nodes").or_insert_with(|| Value::Array(Vec::new()));
    }
    is_repaired
}

/// Removes channels that name no node.
fn drop_pointers(document: &mut Value, notes: &mut Notes) -> bool {
    let mut dropped = 0;
    for animation in list_mut(document, "animations") {
        let Some(channels) = animation.get_mut("channels").and_then(Value::as_array_mut) else {
            continue;
        };
        let before = channels.len();
        channels.retain(|channel| channel.get("target").is_none_or(|t| t.get("node").is_some()));
        dropped += before - channels.len();
    }
    if dropped > 0 {
        notes.warn(format!(
            "{dropped} channels of animations move no nodes (KHR_animation_pointer is not supported) \
             and were ignored"
        ));
    }
    dropped > 0
}

/// Empties malformed animations; the others keep their numbers.
fn empty_animations(document: &mut Value, notes: &mut Notes) -> bool {
    let mut is_repaired = false;
    for (index, animation) in list_mut(document, "animations").iter_mut().enumerate() {
        let read = serde_json::to_vec(animation)
            .and_then(|json| serde_json::from_slice::<gltf::json::Animation>(&json));
        let Err(error) = read else { continue };
        let name = animation.get("name").and_then(Value::as_str).map(str::to_owned);
        let shown = name_or_index(name.as_deref(), "animation", index);
        // The position in the error refers to the reserialized text.
        let reason = error.to_string();
        let reason = reason.split(" at line ").next().unwrap_or_default();
        notes.warn(format!("the animation \"{shown}\" is malformed and was left out: {reason}"));
        *animation = json!({ "channels": [], "samplers": [] });
        if let Some(name) = name {
            animation["name"] = json!(name);
        }
        is_repaired = true;
    }
    is_repaired
}

pub(super) fn list_mut<'a>(value: &'a mut Value, key: &str) -> &'a mut [Value] {
    value.get_mut(key).and_then(Value::as_array_mut).map_or(&mut [], Vec::as_mut_slice)
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
