//! Which of glTF's extensions are understood, and what becomes of the others.

use std::path::Path;

use gltf::json::Root;

use super::Notes;
use crate::SceneError;
use crate::load::files;

/// Those that are understood.
const SUPPORTED: &[&str] = &[
    "EXT_mesh_gpu_instancing",
    "EXT_meshopt_compression",
    "EXT_texture_webp",
    "KHR_draco_mesh_compression",
    "KHR_lights_punctual",
    "KHR_materials_clearcoat",
    "KHR_materials_emissive_strength",
    "KHR_materials_ior",
    "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",
    "KHR_materials_specular",
    "KHR_materials_transmission",
    "KHR_materials_unlit",
    "KHR_mesh_quantization",
    "KHR_meshopt_compression",
    "KHR_node_visibility",
    "KHR_texture_basisu",
    "KHR_texture_transform",
];

/// Those that say nothing about the picture: metadata, and what a user could do with things.
const SILENT: &[&str] = &[
    "EXT_mesh_features",
    "EXT_structural_metadata",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_xmp",
    "KHR_xmp_json_ld",
];

/// Those of which a user should know what the picture lacks.
const REPLACED: &[(&str, &str)] = &[
    ("KHR_materials_anisotropy", "its reflections are the same in all directions"),
    ("KHR_materials_diffuse_transmission", "light does not shine through its surfaces"),
    ("KHR_materials_dispersion", "its glass does not split colours"),
    ("KHR_materials_iridescence", "its surfaces do not change their colour with the angle"),
    ("KHR_materials_variants", "the first look of each surface is shown"),
    ("KHR_materials_volume", "thick glass is shown as a thin pane"),
];

/// Refuses a file that requires what is not understood, and warns of the rest.
pub(super) fn check(file: &Path, root: &mut Root, notes: &mut Notes) -> Result<(), SceneError> {
    let supported = || SUPPORTED.iter().copied();
    let is_known =
        |name: &str| supported().chain(SILENT.iter().copied()).any(|known| known == name);
    let missing: Vec<String> = root
        .extensions_required
        .iter()
        .filter(|name| !is_known(name))
        .map(|name| files::shorten(name))
        .collect();
    if !missing.is_empty() {
        return Err(SceneError::RequiredExtension {
            file: file.to_owned(),
            extensions: missing,
            supported: supported().collect(),
        });
    }
    // The JSON library would refuse some that are read here.
    root.extensions_required.clear();
    for name in root.extensions_used.iter().filter(|name| !is_known(name)) {
        let effect = REPLACED.iter().find(|(replaced, _)| replaced == name);
        let effect = effect.map_or(String::new(), |(_, effect)| format!(": {effect}"));
        notes.warn(format!(
            "the glTF extension {} is not supported and was ignored{effect}",
            files::shorten(name)
        ));
    }
    Ok(())
}
