//! The choice among a file's scenes.

use super::Loader;
use crate::SceneError;
use crate::load::files::shorten;

impl<'a> Loader<'a> {
    /// The root nodes of the scene of this name or number. Without one, those of the scene that the
    /// file marks, or else of the first. A file without scenes shows all root nodes.
    pub(super) fn roots(&mut self, wanted: Option<&str>) -> Result<Vec<usize>, SceneError> {
        let document = self.document;
        let scene = match wanted {
            Some(wanted) => Some(self.find_scene(wanted)?),
            None => document.default_scene().or_else(|| document.scenes().next()),
        };
        if let Some(scene) = scene {
            self.restore_scene(scene.extras());
            return Ok(scene.nodes().map(|node| node.index()).collect());
        }
        let nodes = &self.root().nodes;
        let mut is_child = vec![false; nodes.len()];
        for child in nodes.iter().filter_map(|node| node.children.as_ref()).flatten() {
            is_child[child.value()] = true;
        }
        Ok((0..nodes.len()).filter(|&i| !is_child[i]).collect())
    }

    /// Finds a scene. Names go first: a scene may be called "2".
    fn find_scene(&self, wanted: &str) -> Result<gltf::Scene<'a>, SceneError> {
        let mut scenes = self.document.scenes();
        if let Some(scene) = scenes.clone().find(|scene| scene.name() == Some(wanted)) {
            return Ok(scene);
        }
        let number = wanted.parse().ok();
        number.and_then(|number| scenes.nth(number)).ok_or_else(|| SceneError::UnknownScene {
            file: self.file.to_owned(),
            wanted: shorten(wanted),
            known: self
                .document
                .scenes()
                .map(|scene| match scene.name() {
                    Some(name) => format!("{} \"{}\"", scene.index(), shorten(name)),
                    None => scene.index().to_string(),
                })
                .collect(),
        })
    }
}
