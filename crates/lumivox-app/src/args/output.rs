//! The output's path, checked before any work is done for it.

use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

use anyhow::bail;
use lumivox_console::Failure;
use lumivox_render::ImageFormat;
use lumivox_scene::write_atomically;

/// Checks that a picture can be written to `file`: its format, its folder, and the folder's
/// permissions.
///
/// # Errors
/// A [`lumivox_render::RenderError::UnknownFormat`], or a [`Failure`] that names the file and the
/// obstacle.
pub fn check(file: &Path) -> anyhow::Result<()> {
    ImageFormat::from_path(file)?;
    check_folder(file, &folder_of(file))
}

/// Checks that `file` ends in `.EXTENSION`, as `rule` says, and can be written.
///
/// # Errors
/// A [`Failure`] that names the file and the obstacle.
pub fn check_kind(file: &Path, extension: &str, rule: &str) -> anyhow::Result<()> {
    if !file.extension().unwrap_or_default().eq_ignore_ascii_case(extension) {
        let name = file.display();
        bail!(Failure::input(format!("{name}: {rule}; end the name in .{extension}")));
    }
    check_folder(file, &folder_of(file))
}

/// Checks that a new file or folder `what` can be made in `folder`.
///
/// # Errors
/// A [`Failure`] of output that names both and the obstacle.
pub fn check_folder(what: &Path, folder: &Path) -> anyhow::Result<()> {
    let refuse = |reason: &str, remedy: &str| -> anyhow::Result<()> {
        bail!(Failure::output(format!("{}: {reason}; {remedy}", what.display())))
    };
    if what.is_dir() {
        return refuse("a folder of that name is in the way", "choose another name");
    }
    match folder.metadata() {
        Ok(metadata) if metadata.is_dir() => {}
        Ok(_) => {
            let reason = format!("{} is a file, not a folder", folder.display());
            return refuse(&reason, "choose another folder");
        }
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            let reason = format!("there is no folder {}", folder.display());
            return refuse(&reason, "make it first, or choose another");
        }
        Err(error) => {
            let reason = format!("the folder {} cannot be read: {error}", folder.display());
            return refuse(&reason, "check the path and its permissions");
        }
    }
    // Many things can deny permission; only trying is certain. The file is removed on drop.
    if let Err(error) = tempfile::Builder::new().prefix(".lumivox-").tempfile_in(folder) {
        // The error itself names the temporary file, which means nothing to the user.
        let reason = io::Error::from(error.kind());
        let reason = format!("no file can be made in {}: {reason}", folder.display());
        return refuse(&reason, "check the folder's permissions, or choose another");
    }
    Ok(())
}

/// Makes a folder if it is missing, and checks that files can be made in it.
///
/// # Errors
/// A [`Failure`] of output that names the folder and the obstacle.
pub fn make_folder(folder: &Path) -> anyhow::Result<()> {
    std::fs::create_dir_all(folder)
        .map_err(|e| Failure::output(format!("{}: cannot be made: {e}", folder.display())))?;
    check_folder(&folder.join("x"), folder)
}

/// Writes a file, complete or not at all.
///
/// # Errors
/// A [`Failure`] of output that names the file.
pub fn write(file: &Path, bytes: &[u8]) -> anyhow::Result<()> {
    write_atomically(file, |out| out.write_all(bytes)).map_err(|error| {
        let reason = format!("{}: cannot be written: {error}", file.display());
        Failure::output(reason + "; check the folder and its permissions").into()
    })
}

/// The folder of a file.
pub fn folder_of(file: &Path) -> PathBuf {
    match file.parent() {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn checking_an_output_path_creates_no_file() {
        let folder = tempfile::tempdir().unwrap();
        check(&folder.path().join("picture.png")).unwrap();
        check(&folder.path().join("picture.EXR")).unwrap();
        assert_eq!(folder.path().read_dir().unwrap().count(), 0);
    }

    #[test]
    fn bad_output_paths_are_refused_by_name() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file.png");
        std::fs::write(&file, "").unwrap();
        std::fs::create_dir(folder.path().join("folder.png")).unwrap();
        for (path, needle) in [
            ("missing/a.png", "there is no folder"),
            ("file.png/a.png", "is a file, not a folder"),
            ("folder.png", "in the way"),
            ("a.jpg", ".exr"),
            ("a", ".png"),
        ] {
            let path = folder.path().join(path);
            let error = check(&path).unwrap_err().to_string();
            assert!(error.contains(needle), "{error}");
            assert!(error.contains(&path.display().to_string()), "{error}");
        }
    }

    #[test]
    fn a_bare_name_is_in_the_current_folder() {
        assert_eq!(folder_of(Path::new("a.png")), Path::new("."));
        assert_eq!(folder_of(Path::new("b/a.png")), Path::new("b"));
    }
}
