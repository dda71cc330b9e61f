//! The console's access to the disk: files, and scenes by name in folders.

use std::collections::HashSet;
use std::path::{MAIN_SEPARATOR, Path, PathBuf};

use lumivox_console::{Failure, Outside, Reading, SceneRequest, SceneSource, is_scene, suggest};
use lumivox_scene::{builtin, extensions_in_words};

use crate::args::output;
use crate::args::scene::{self, within};
use crate::light;

/// The console's access to the disk.
#[derive(Clone, Copy, Debug)]
pub struct Disk;

impl Outside for Disk {
    fn scenes(&self, open: Option<&SceneRequest>) -> Vec<String> {
        scenes(&folders(open))
    }

    fn find(&self, name: &str, open: Option<&SceneRequest>) -> anyhow::Result<SceneSource> {
        let source = scene::source(name.into());
        let SceneSource::File(path) = &source else { return Ok(source) };
        if path.is_file() {
            return Ok(source);
        }
        let folders = folders(open);
        if let Some(file) = folders.iter().find_map(|folder| within(folder, path)) {
            return Ok(SceneSource::File(file));
        }
        if path.is_dir() {
            return Ok(source);
        }
        let known = scenes(&folders);
        // Also compare names without their prefix.
        let short = |known: &str| known.strip_prefix("builtin:").unwrap_or(known).to_owned();
        let shorts: Vec<String> = known.iter().map(|known| short(known)).collect();
        let like = suggest::like(&short(name), shorts.iter().map(String::as_str));
        let like = like.and_then(|like| known.iter().find(|known| short(known) == like));
        let remedy = match like {
            Some(like) => format!("; did you mean \"{like}\"?"),
            None => "; `scenes` lists those that are found by name".to_owned(),
        };
        let kinds = extensions_in_words();
        Err(Failure::input(format!(
            "there is no file \"{name}\", nor a scene of that name ({kinds}) in a folder scenes{remedy}"
        ))
        .into())
    }

    fn check(&self, opening: &SceneRequest) -> anyhow::Result<()> {
        scene::check(&opening.source)?;
        Ok(light::check(&opening.light)?)
    }

    fn read<'a>(&'a self, file: &'a str) -> Reading<'a> {
        Box::pin(std::future::ready(read(Path::new(file)).map_err(Into::into)))
    }

    fn check_output(&self, file: &str) -> anyhow::Result<()> {
        let path = Path::new(file);
        output::check_folder(path, &output::folder_of(path))
    }

    fn write(&mut self, file: &str, bytes: &[u8]) -> anyhow::Result<()> {
        output::write(Path::new(file), bytes)
    }
}

/// Reads a file that a command names.
///
/// # Errors
/// When it cannot be read.
pub fn read(file: &Path) -> Result<Vec<u8>, Failure> {
    lumivox_scene::read_regular(file).map_err(|error| {
        let name = file.display();
        Failure::input(format!("{name}: cannot be read: {error}; check the path"))
    })
}

/// The folders in which scenes are found by name: `scenes` in the working folder, beside the open
/// scene, and beside its folder (VXCT keeps `models` there).
fn folders(open: Option<&SceneRequest>) -> Vec<PathBuf> {
    let mut folders = vec![PathBuf::from("scenes")];
    if let Some(SceneSource::File(file)) = open.map(|opening| &opening.source) {
        let beside = file.parent().unwrap_or(Path::new("")).to_owned();
        folders.push(beside.join("scenes"));
        folders.push(beside);
    }
    folders
}

/// Names of scenes: the built-in ones, and those of files in folders, without extension.
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

/// The files and folders whose paths start with `start`; folders end in `/`.
pub fn files(start: &str) -> Vec<String> {
    let (folder, name) =
        start.rsplit_once(['/', MAIN_SEPARATOR]).map_or(("", start), |(f, n)| (f, n));
    let prefix = start.strip_suffix(name).unwrap_or_default();
    let path = if prefix.is_empty() {
        "."
    } else if folder.is_empty() {
        "/"
    } else {
        folder
    };
    let Ok(entries) = Path::new(path).read_dir() else { return Vec::new() };
    let mut found: Vec<String> = entries
        .flatten()
        .filter_map(|entry| {
            let file = entry.file_name().into_string().ok()?;
            let is_folder = entry.path().is_dir();
            let fits = file.starts_with(name) && (!file.starts_with('.') || name.starts_with('.'));
            let end = if is_folder { "/" } else { "" };
            fits.then(|| format!("{prefix}{file}{end}"))
        })
        .collect();
    found.sort_unstable();
    found
}
