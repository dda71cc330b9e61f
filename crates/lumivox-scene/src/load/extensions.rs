//! The extensions of readable files.

/// The extensions of the files that [`Scene::load`](crate::Scene::load) reads, in lower case.
pub const EXTENSIONS: &[&str] = &[
    "gltf",
    "glb",
    "obj",
    "ply",
    "stl",
    #[cfg(feature = "vxct")]
    "scene",
    #[cfg(feature = "vxct")]
    "vxct",
    #[cfg(feature = "vxct")]
    "txt",
];

/// All extensions as a text: `.gltf or .glb`.
pub fn extensions_in_words() -> String {
    let dotted: Vec<String> = EXTENSIONS.iter().map(|extension| format!(".{extension}")).collect();
    match dotted.split_last() {
        Some((last, rest)) if !rest.is_empty() => format!("{} or {last}", rest.join(", ")),
        _ => dotted.concat(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scene, SceneError};

    #[test]
    fn every_extension_has_a_loader_in_any_case() {
        for extension in EXTENSIONS {
            for extension in [(*extension).to_owned(), extension.to_uppercase()] {
                let error = Scene::load(format!("no such file.{extension}")).unwrap_err();
                assert!(matches!(error, SceneError::Read { .. }), "{error}");
            }
        }
        let error = Scene::load("scene.blend").unwrap_err();
        assert!(matches!(error, SceneError::UnknownFormat { .. }), "{error}");
        for extension in EXTENSIONS {
            assert!(error.to_string().contains(&format!(".{extension}")), "{error}");
        }
    }

    #[test]
    #[cfg(not(feature = "vxct"))]
    fn a_build_without_vxct_says_so() {
        for extension in ["scene", "vxct", "txt"] {
            let error = Scene::load(format!("room.{extension}")).unwrap_err();
            assert!(matches!(error, SceneError::WithoutVxct { .. }), "{error}");
            let text = error.to_string();
            assert!(
                text.contains("does not read scenes of VXCT") && text.contains("feature vxct"),
                "{text}"
            );
        }
    }
}
