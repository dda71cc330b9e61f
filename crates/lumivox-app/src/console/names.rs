//! What arguments can name, apart from the console: cheap to copy to other threads.

use std::collections::HashSet;
use std::path::{Path, PathBuf};

use lumivox_scene::{EXTENSIONS, builtin};

use super::Console;
use crate::args::camera::{FRAMING, INSIDE, OUTSIDE};

/// Names of what there is now.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Names {
    /// Objects.
    pub objects: Vec<String>,
    /// Materials.
    pub materials: Vec<String>,
    /// Lights.
    pub lights: Vec<String>,
    /// Cameras of the scene, and the views that every scene has.
    pub cameras: Vec<String>,
    /// Cameras that were stored under names.
    pub stored: Vec<String>,
    /// Animations, and `all`.
    pub animations: Vec<String>,
    /// Built-in scenes, and those in folders of scenes.
    pub scenes: Vec<String>,
}

impl Console {
    /// What arguments can name now.
    pub fn names(&self) -> Names {
        let explorer = &self.explorer;
        let scene = explorer.scene();
        let cameras = scene.into_iter().flat_map(|scene| &scene.cameras);
        let animations = scene.map(lumivox_scene::Scene::animations).unwrap_or_default();
        let animations: Vec<String> =
            animations.into_iter().map(|animation| animation.name).collect();
        let all = if animations.is_empty() { None } else { Some("all".to_owned()) };
        Names {
            objects: explorer.object_names(),
            materials: explorer.material_names(),
            lights: explorer.light_names(),
            cameras: cameras
                .map(|camera| camera.name.clone())
                .chain([FRAMING, OUTSIDE, INSIDE].map(str::to_owned))
                .collect(),
            stored: explorer.stored_cameras().map(|(name, _)| name.to_owned()).collect(),
            animations: animations.into_iter().chain(all).collect(),
            scenes: scenes(&folders(self)),
        }
    }
}

/// The folders where scenes are looked for by name: `scenes` in the working folder, beside the scene that is open, and
/// beside its folder (VXCT keeps `models` there).
pub fn folders(console: &Console) -> Vec<PathBuf> {
    let mut folders = vec![PathBuf::from("scenes")];
    if let Some(opening) = console.opening()
        && let crate::args::scene::SceneSource::File(file) = &opening.source
    {
        let beside = file.parent().unwrap_or(Path::new("")).to_owned();
        folders.push(beside.join("scenes"));
        folders.push(beside);
    }
    folders
}

/// Names of scenes: the built-in ones, and files in folders without their extensions.
fn scenes(folders: &[PathBuf]) -> Vec<String> {
    let mut names: Vec<String> =
        builtin::names().iter().map(|name| format!("builtin:{name}")).collect();
    for folder in folders {
        let Ok(entries) = folder.read_dir() else { continue };
        let mut found: Vec<String> = entries
            .flatten()
            .map(|entry| entry.path())
            .filter(|path| is_scene(path))
            .filter_map(|path| Some(path.file_stem()?.to_str()?.to_owned()))
            .collect();
        found.sort_unstable();
        names.extend(found);
    }
    let mut seen = HashSet::new();
    names.retain(|name| seen.insert(name.clone()));
    names
}

/// Whether a file's extension is one that loads.
pub fn is_scene(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}
