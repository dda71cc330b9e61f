//! The glTF extensions that are understood, and the treatment of the others.

use std::path::Path;

use gltf::json::Root;

use super::Notes;
use crate::SceneError;
use crate::load::files;

/// The supported extensions.
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

/// Extensions that do not affect the picture: metadata, sound, and interaction with users.
const SILENT: &[&str] = &[
    "AGI_articulations",
    "AGI_stk_metadata",
    "EXT_feature_metadata",
    "EXT_instance_features",
    "EXT_mesh_features",
    "EXT_mesh_manifold",
    "EXT_structural_metadata",
    "KHR_audio_emitter",
    "KHR_interactivity",
    "KHR_node_hoverability",
    "KHR_node_selectability",
    "KHR_physics_rigid_bodies",
    "KHR_xmp",
    "KHR_xmp_json_ld",
    "MSFT_audio_emitter",
    "VRM",
    "VRMC_node_constraint",
    "VRMC_springBone",
    "VRMC_vrm",
];

/// Unsupported extensions without which the picture is nearly right, and the effect of their
/// absence.
const REPLACED: &[(&str, &str)] = &[
    ("CESIUM_primitive_outline", "its outlines are not drawn"),
    ("EXT_lights_ies", "its lamps shine as if they had no profile"),
    ("EXT_lights_image_based", "the surroundings that it brings are not read"),
    ("EXT_texture_avif", "its images of that kind have a stand-in"),
    ("KHR_animation_pointer", "what it moves stays as it is"),
    ("KHR_materials_anisotropy", "its reflections are the same in all directions"),
    ("KHR_materials_diffuse_transmission", "light does not shine through its surfaces"),
    ("KHR_materials_dispersion", "its glass does not split colours"),
    ("KHR_materials_iridescence", "its surfaces do not change their colour with the angle"),
    ("KHR_materials_variants", "the first look of each surface is shown"),
    ("KHR_materials_volume", "thick glass is shown as a thin pane"),
    ("MSFT_lod", "the finest level of detail is shown"),
    ("MSFT_texture_dds", "its images of that kind have a stand-in"),
    ("VRMC_materials_mtoon", "its surfaces are lit as real ones, not as drawings"),
];

/// Refuses a file that requires an unsupported extension which may change the picture, unless
/// `ignore_required` is set; warns about other unsupported extensions.
pub(super) fn check(
    file: &Path,
    root: &mut Root,
    ignore_required: bool,
    notes: &mut Notes,
) -> Result<(), SceneError> {
    let supported = || SUPPORTED.iter().copied();
    let is_known =
        |name: &str| supported().chain(SILENT.iter().copied()).any(|known| known == name);
    let effect = |name: &str| REPLACED.iter().find(|(replaced, _)| *replaced == name);
    let missing: Vec<String> = root
        .extensions_required
        .iter()
        .filter(|name| !is_known(name) && effect(name).is_none())
        .map(|name| files::shorten(name))
        .collect();
    if !missing.is_empty() && !ignore_required {
        return Err(SceneError::RequiredExtension {
            file: file.to_owned(),
            extensions: missing,
            supported: supported().collect(),
        });
    }
    if !missing.is_empty() {
        notes.warn(format!(
            "the file requires the glTF extension {}, which is not supported and was ignored: what is \
             shown may be wrong",
            missing.join(", ")
        ));
    }
    // The JSON library would refuse some extensions that are read here.
    let required = std::mem::take(&mut root.extensions_required);
    // A required extension should also be listed as used, but some files omit it.
    for name in root.extensions_used.iter().chain(&required).filter(|name| !is_known(name)) {
        let effect = effect(name).map(|(_, effect)| format!(": {effect}"));
        if effect.is_none() && required.contains(name) {
            continue;
        }
        notes.warn(format!(
            "the glTF extension {} is not supported and was ignored{}",
            files::shorten(name),
            effect.unwrap_or_default()
        ));
    }
    Ok(())
}
