//! The extensions of readable files.

/// The extensions of the files that [`Scene::load`](crate::Scene::load) reads, in lower case.
/// Formats whose feature is off are not included.
pub const EXTENSIONS: &[&str] = &[
    #[cfg(feature = "gltf")]
    "gltf",
    #[cfg(feature = "gltf")]
    "glb",
    #[cfg(feature = "obj")]
    "obj",
    #[cfg(feature = "ply")]
    "ply",
    #[cfg(feature = "stl")]
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
    fn a_format_that_is_left_out_names_its_feature() {
        for (extension, feature, format) in [
            ("gltf", "gltf", "glTF"),
            ("GLB", "gltf", "glTF"),
            ("obj", "obj", "OBJ"),
            ("ply", "ply", "PLY"),
            ("stl", "stl", "STL"),
            ("scene", "vxct", "scenes of VXCT"),
            ("vxct", "vxct", "scenes of VXCT"),
            ("txt", "vxct", "scenes of VXCT"),
        ] {
            let file = format!("no such room.{extension}");
            let error = Scene::load(&file).unwrap_err();
            if EXTENSIONS.contains(&extension.to_lowercase().as_str()) {
                assert!(matches!(error, SceneError::Read { .. }), "{error}");
                continue;
            }
            assert!(matches!(error, SceneError::LeftOut { .. }), "{error}");
            let text = error.to_string();
            for part in [&file, &format!("not read {format};"), &format!("feature {feature} ")] {
                assert!(text.contains(part), "{text}");
            }
        }
    }
}
