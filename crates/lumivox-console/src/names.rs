//! Names that can be arguments, separate from the console, so that other threads can have copies.

use std::path::Path;

use lumivox_scene::EXTENSIONS;

use super::Console;
use crate::values::camera::{FRAMING, INSIDE, OUTSIDE};

/// The present names.
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
    /// Stored cameras.
    pub stored: Vec<String>,
    /// Animations, and `all`.
    pub animations: Vec<String>,
    /// Built-in scenes, and those in folders of scenes.
    pub scenes: Vec<String>,
}

impl Console {
    /// The names that can be arguments now.
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
            scenes: self.outside.scenes(self.scene_request()),
        }
    }
}

/// Whether a file has the extension of a scene.
pub fn is_scene(path: &Path) -> bool {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    extension.is_some_and(|extension| EXTENSIONS.contains(&extension.as_str()))
}
