//! Scenes on the command line: finding and reading them.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use lumivox_console::{BUILTIN, Failure, LoadArgs, SceneSource};
use lumivox_scene::{
    EXTENSIONS, LoadOptions, LoadProgress, Scene, SceneError, builtin, check_regular,
};

use crate::progress::ProgressDisplay;

/// Parses a scene's name on the command line; files are also looked up in the folder `scenes`.
pub fn source(text: OsString) -> SceneSource {
    match text.to_str().map(SceneSource::named) {
        Some(builtin @ SceneSource::Builtin(_)) => builtin,
        _ => SceneSource::File(found(text.into())),
    }
}

/// Resolves a path, or else a name in the folder `scenes`, as in VXCT.
fn found(path: PathBuf) -> PathBuf {
    if path.exists() {
        return path;
    }
    within(Path::new("scenes"), &path).unwrap_or(path)
}

/// Finds a scene's file in a folder by its name, with or without one of the known extensions.
pub fn within(folder: &Path, name: &Path) -> Option<PathBuf> {
    let file = folder.join(name);
    if file.is_file() {
        return Some(file);
    }
    EXTENSIONS.iter().find_map(|extension| {
        let mut with_extension = file.clone().into_os_string();
        with_extension.push(format!(".{extension}"));
        let with_extension = PathBuf::from(with_extension);
        with_extension.is_file().then_some(with_extension)
    })
}

/// Checks that the scene exists, which is cheap.
///
/// # Errors
/// When there is no built-in scene or no file of that name.
pub fn check(source: &SceneSource) -> anyhow::Result<()> {
    match source {
        SceneSource::Builtin(name) if builtin::about(name).is_some() => Ok(()),
        SceneSource::Builtin(name) => {
            let known = builtin::names().to_vec();
            Err(SceneError::UnknownBuiltin { name: name.clone(), known }.into())
        }
        SceneSource::File(file) => match check_regular(file) {
            Ok(_) => Ok(()),
            Err(_) if file.is_dir() => Err(Failure::input(format!(
                "{}: is a folder; give a {} file",
                file.display(),
                lumivox_scene::extensions_in_words()
            ))
            .into()),
            Err(_) if is_builtin_without_prefix(source) => {
                let file = file.display();
                Err(Failure::input(format!(
                    "{file}: there is no such file; did you mean {BUILTIN}{file}?"
                ))
                .into())
            }
            Err(error) => Err(SceneError::Read { file: file.clone(), source: error }.into()),
        },
    }
}

/// Makes a built-in scene, or reads a file.
///
/// # Errors
/// As [`Scene::load_with`] and [`builtin::scene`], and when options for files are given with a
/// built-in scene.
pub fn load(
    source: &SceneSource,
    args: &LoadArgs,
    progress: &ProgressDisplay,
) -> anyhow::Result<Scene> {
    args.check(source)?;
    let mut scene = match source {
        SceneSource::Builtin(name) => builtin::scene(name)?,
        SceneSource::File(file) => {
            let mut tell =
                |step: LoadProgress| progress.set_share(words(step.stage), step.done, step.total);
            let mut options = LoadOptions { progress: Some(&mut tell), ..args.options() };
            Scene::load_with(file, &mut options)?
        }
    };
    args.turn(&mut scene);
    Ok(scene)
}

/// The stamp of a scene's file, to detect a changed file: its size in bytes, and the time of its
/// last change in milliseconds since 1970. `None` for built-in scenes and unreadable files.
pub fn stamp_of(source: &SceneSource) -> Option<(u64, u64)> {
    let SceneSource::File(file) = source else { return None };
    stamp(file)
}

fn is_builtin_without_prefix(source: &SceneSource) -> bool {
    matches!(source, SceneSource::File(file)
        if file.to_str().is_some_and(|name| builtin::names().contains(&name)))
}

/// The stamp of a file, as in [`stamp_of`].
pub fn stamp(file: &Path) -> Option<(u64, u64)> {
    let metadata = std::fs::metadata(file).ok()?;
    let changed = metadata.modified().ok()?.duration_since(SystemTime::UNIX_EPOCH).ok()?;
    Some((metadata.len(), changed.as_millis() as u64))
}

/// The name of a loader's stage in the progress.
fn words(stage: &'static str) -> &'static str {
    match stage {
        "textures" => "loading textures",
        other => other,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn source(text: &str) -> SceneSource {
        super::source(text.into())
    }

    #[test]
    fn the_builtin_prefix_marks_names_of_built_in_scenes() {
        assert_eq!(source("builtin:cornell"), SceneSource::Builtin("cornell".to_owned()));
        assert_eq!(source("a/b.glb"), SceneSource::File("a/b.glb".into()));
        assert_eq!(source("builtin:cornell").to_string(), "builtin:cornell");
    }

    #[test]
    fn unknown_scenes_are_named_with_a_suggestion() {
        let error = check(&source("builtin:corn")).unwrap_err().to_string();
        assert!(error.contains("\"corn\"") && error.contains("cornell"), "{error}");
        let error = check(&source("cornell")).unwrap_err().to_string();
        assert!(error.contains("did you mean builtin:cornell?"), "{error}");
        let error = check(&source("no/such.glb")).unwrap_err().to_string();
        assert!(error.contains("no/such.glb"), "{error}");
        let error = check(&source("/")).unwrap_err().to_string();
        assert!(error.contains("is a folder"), "{error}");
    }
}
