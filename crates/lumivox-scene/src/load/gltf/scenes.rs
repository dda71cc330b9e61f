//! The choice among a file's scenes.

use super::Loader;
use crate::SceneError;
use crate::load::files::shorten;

/// The most scenes that an error lists.
const MOST_LISTED: usize = 20;

impl<'a> Loader<'a> {
    /// The root nodes of the scene `wanted` (a name or a number); by default of the file's default
    /// scene, else of the first. Without scenes, all root nodes.
    pub(super) fn roots(&mut self, wanted: Option<&str>) -> Result<Vec<usize>, SceneError> {
        let document = self.document;
        let scene = match wanted {
            Some(wanted) => Some(self.find_scene(wanted)?),
            None => document.default_scene().or_else(|| document.scenes().next()),
        };
        if let Some(scene) = scene {
            self.restore_scene(scene.extras());
            return Ok(self.distinct(scene.nodes().map(|node| node.index()).collect()));
        }
        let nodes = &self.root().nodes;
        let mut is_child = vec![false; nodes.len()];
        for child in nodes.iter().filter_map(|node| node.children.as_ref()).flatten() {
            is_child[child.value()] = true;
        }
        Ok((0..nodes.len()).filter(|&i| !is_child[i]).collect())
    }

    /// The listed roots without repetitions, and without those that are below another root.
    fn distinct(&mut self, mut roots: Vec<usize>) -> Vec<usize> {
        let nodes = &self.document.as_json().nodes;
        let (mut is_below, mut is_known) = (vec![false; nodes.len()], vec![false; nodes.len()]);
        for &root in &roots {
            let mut open = if is_below[root] { vec![] } else { vec![root] };
            while let Some(node) = open.pop() {
                for child in nodes[node].children.iter().flatten().map(gltf::json::Index::value) {
                    // The traversal of the nodes reports a root that is below itself.
                    if child != root && !std::mem::replace(&mut is_below[child], true) {
                        open.push(child);
                    }
                }
            }
        }
        let listed = roots.len();
        roots.retain(|&root| !is_below[root] && !std::mem::replace(&mut is_known[root], true));
        if roots.len() < listed {
            self.notes.warn(format!(
                "{} roots of the scene are listed twice or are children of other nodes; each is \
                 shown once, below its parent",
                listed - roots.len()
            ));
        }
        roots
    }

    /// Finds a scene. Names are tried first: a scene may be called "2".
    fn find_scene(&self, wanted: &str) -> Result<gltf::Scene<'a>, SceneError> {
        let mut scenes = self.document.scenes();
        if let Some(scene) = scenes.clone().find(|scene| scene.name() == Some(wanted)) {
            return Ok(scene);
        }
        let number = wanted.parse().ok();
        number.and_then(|number| scenes.nth(number)).ok_or_else(|| SceneError::UnknownScene {
            file: self.file.to_owned(),
            wanted: shorten(wanted),
            known: self.document.scenes().map(|scene| number_and_name(&scene)).collect(),
        })
    }
}

fn number_and_name(scene: &gltf::Scene<'_>) -> String {
    match scene.name() {
        Some(name) => format!("{} \"{}\"", scene.index(), shorten(name)),
        None => scene.index().to_string(),
    }
}

/// Adds the file's scenes that have meshes to the error of a scene without triangles.
pub(super) fn with_others(error: SceneError, document: &gltf::Document) -> SceneError {
    let SceneError::NoTriangles { file, reason } = error else { return error };
    let has_mesh = |scene: &gltf::Scene<'_>| {
        let mut is_met = vec![false; document.nodes().len()];
        let mut open: Vec<_> = scene.nodes().collect();
        while let Some(node) = open.pop() {
            if node.mesh().is_some() {
                return true;
            }
            if !std::mem::replace(&mut is_met[node.index()], true) {
                open.extend(node.children());
            }
        }
        false
    };
    let scenes = document.scenes().take(MOST_LISTED).filter(has_mesh);
    let scenes: Vec<_> = scenes.map(|scene| number_and_name(&scene)).collect();
    let reason = match scenes.as_slice() {
        [] => reason,
        _ if document.scenes().len() < 2 => reason,
        _ => format!(
            "{reason}; scenes of the file with meshes, for --scene-in-file: {}",
            scenes.join(", ")
        ),
    };
    SceneError::NoTriangles { file, reason }
}
