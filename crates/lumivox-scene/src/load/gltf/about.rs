//! Metadata of a file.

use gltf::json::Root;

use super::name_or_index;
use crate::LoadNotes;
use crate::load::files::shorten;

/// The most names of each kind: a hostile file could have millions.
const MOST: usize = 1000;

/// The notes on the generator, the extensions and the scenes.
pub(super) fn about(root: &Root) -> LoadNotes {
    let names = |names: &[String]| names.iter().take(MOST).map(|name| shorten(name)).collect();
    let scenes = root.scenes.iter().take(MOST).enumerate();
    LoadNotes {
        generator: root.asset.generator.as_deref().map(shorten),
        extensions_used: names(&root.extensions_used),
        extensions_required: names(&root.extensions_required),
        scenes: scenes
            .map(|(index, scene)| name_or_index(scene.name.as_deref(), "scene", index))
            .collect(),
        ..LoadNotes::default()
    }
}
