//! Removes references to missing things without which the scene can be shown, with a warning for
//! each.

use gltf::json::validation::{Error as Fault, Validate};
use gltf::json::{Path, Root};
use serde_json::{Value, json};

use super::repair::list_mut;
use super::{Notes, container, name_or_index};

/// The name of the image-less texture that replaces textures that do not exist.
pub(super) const NO_TEXTURE: &str = "(a texture that does not exist)";

/// The document without such references; `None` if there are none.
pub(super) fn mended(root: &Root, json: &[u8], notes: &mut Notes) -> Option<Vec<u8>> {
    // Validation reads these indices unchecked; a file with invalid ones is refused later.
    container::check_position_indices(root).ok()?;
    let mut any = false;
    root.validate(root, Path::new, &mut |_, fault| any |= fault == Fault::IndexOutOfBounds);
    if !any {
        return None;
    }
    let mut document: Value = serde_json::from_slice(json).ok()?;
    let count = |list: &str| document[list].as_array().map_or(0, Vec::len);
    let [scenes, textures, samplers] = ["scenes", "textures", "samplers"].map(count);
    let [images, materials, cameras] = ["images", "materials", "cameras"].map(count);
    let lights = document["extensions"][LIGHTS]["lights"].as_array().map_or(0, Vec::len);

    if let Some(said) = take(&mut document, "scene", scenes) {
        let shown = if scenes == 0 { "all its nodes are shown" } else { "the first is shown" };
        notes.warn(format!("it marks {said}; {shown}"));
    }
    for (index, mesh) in list_mut(&mut document, "meshes").iter_mut().enumerate() {
        let name = name_of(mesh, "mesh", index);
        for primitive in list_mut(mesh, "primitives") {
            if let Some(said) = take(primitive, "material", materials) {
                notes.warn(format!("mesh \"{name}\" names {said}; it has the default look"));
            }
        }
    }
    for (index, node) in list_mut(&mut document, "nodes").iter_mut().enumerate() {
        let name = name_of(node, "node", index);
        let camera = take(node, "camera", cameras);
        let on_node = node.pointer_mut("/extensions/KHR_lights_punctual");
        let light = on_node.and_then(|on_node| take(on_node, "light", lights));
        if light.is_some() {
            node["extensions"].as_object_mut().map(|extensions| extensions.remove(LIGHTS));
        }
        for said in [camera, light].into_iter().flatten() {
            notes.warn(format!("{name} names {said}; that was left out"));
        }
    }
    for (index, texture) in list_mut(&mut document, "textures").iter_mut().enumerate() {
        if let Some(said) = take(texture, "source", images) {
            notes.warn(format!("texture {index}: its source is {said}; that was left out"));
        }
        if let Some(said) = take(texture, "sampler", samplers) {
            notes.warn(format!("texture {index} names {said}; the default one is used"));
        }
    }
    let mut are_missing = false;
    for (index, material) in list_mut(&mut document, "materials").iter_mut().enumerate() {
        let name = name_of(material, "material", index);
        redirect(material, textures, &mut |key, said| {
            are_missing = true;
            notes.warn(format!("material \"{name}\": its {key} is {said}; it counts as missing"));
        });
    }
    if are_missing {
        if textures == 0 {
            document["textures"] = json!([]);
        }
        document["textures"].as_array_mut()?.push(json!({ "name": NO_TEXTURE }));
    }
    serde_json::to_vec(&document).ok()
}

const LIGHTS: &str = "KHR_lights_punctual";

fn name_of(value: &Value, kind: &str, index: usize) -> String {
    name_or_index(value["name"].as_str(), kind, index)
}

/// Removes an index that is not below `count`, and returns a description of it.
fn take(value: &mut Value, key: &str, count: usize) -> Option<String> {
    let index = value.get(key)?.as_u64().filter(|&index| index >= count as u64)?;
    value.as_object_mut()?.remove(key);
    let kind = if key == "source" { "image" } else { key };
    Some(format!("{kind} {index}, but there are only {count}"))
}

/// Redirects references to missing textures, in a material or its extensions, to the index after
/// the last texture.
fn redirect(value: &mut Value, count: usize, tell: &mut dyn FnMut(&str, String)) {
    for (key, value) in value.as_object_mut().into_iter().flatten() {
        let index = value["index"].as_u64().filter(|_| key.ends_with("Texture"));
        if let Some(index) = index.filter(|&index| index >= count as u64) {
            value["index"] = json!(count);
            tell(key, format!("texture {index}, but there are only {count}"));
        }
        redirect(value, count, tell);
    }
}
