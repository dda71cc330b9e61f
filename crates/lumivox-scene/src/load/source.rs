//! The source of files: the disk, or the caller.
//!
//! A program in a browser has no disk, and one that unpacks archives has its files in memory. Both
//! provide a [`FileSource`], and loaders then only use this source.

use std::borrow::Cow;
use std::collections::HashMap;
use std::hash::BuildHasher;
use std::io;
use std::path::{Component, Path};

/// Files that are not on the disk, for [`LoadOptions::files`](crate::LoadOptions::files).
///
/// ```
/// # use std::collections::HashMap;
/// # use lumivox_scene::{LoadOptions, Scene, Shading};
/// // Dropped on a page, say: a scene with its files.
/// let files = HashMap::from([
///     (
///         "room.obj".to_owned(),
///         b"mtllib room.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl red\nf 1 2 3\n".to_vec(),
///     ),
///     ("room.mtl".to_owned(), b"newmtl red\nKd 1 0 0\n".to_vec()),
/// ]);
/// let mut options = LoadOptions { files: Some(&files), ..LoadOptions::default() };
/// let scene = Scene::load_with("room.obj", &mut options)?;
/// assert!(matches!(scene.materials[0].shading, Shading::Phong(red) if red.diffuse.y == 0.0));
/// # Ok::<(), lumivox_scene::SceneError>(())
/// ```
pub trait FileSource {
    /// The bytes of the file at `path`: the scene's own path as given, or the path of a file that
    /// it names, in the scene's folder. Folders are separated by `/`, and the path has no `.` in
    /// it.
    ///
    /// # Errors
    /// [`io::ErrorKind::NotFound`], or another error, which the loader's message quotes.
    fn read(&self, path: &str) -> io::Result<Cow<'_, [u8]>>;

    /// The path of a file that differs from `path` only in case: files made on Windows often name
    /// each other so. Default: none.
    fn find_ignoring_case(&self, path: &str) -> Option<String> {
        let _ = path;
        None
    }
}

impl<S: BuildHasher> FileSource for HashMap<String, Vec<u8>, S> {
    fn read(&self, path: &str) -> io::Result<Cow<'_, [u8]>> {
        let bytes = self.get(path);
        bytes.map(|bytes| Cow::Borrowed(bytes.as_slice())).ok_or_else(|| {
            io::Error::new(io::ErrorKind::NotFound, "it is not among the scene's files")
        })
    }

    fn find_ignoring_case(&self, path: &str) -> Option<String> {
        let wanted = path.to_lowercase();
        // The least of several, so that every run picks the same one.
        self.keys().filter(|key| key.to_lowercase() == wanted).min().cloned()
    }
}

/// A source with the scene's file in memory, and other files from another source, if there is one.
pub(super) struct Memory<'a> {
    pub(super) name: &'a str,
    pub(super) bytes: &'a [u8],
    pub(super) others: Option<&'a dyn FileSource>,
}

impl FileSource for Memory<'_> {
    fn read(&self, path: &str) -> io::Result<Cow<'_, [u8]>> {
        if path == key(Path::new(self.name)) {
            return Ok(Cow::Borrowed(self.bytes));
        }
        match self.others {
            Some(others) => others.read(path),
            None => Err(io::Error::new(
                io::ErrorKind::NotFound,
                "the scene came from memory without its other files",
            )),
        }
    }

    fn find_ignoring_case(&self, path: &str) -> Option<String> {
        self.others.and_then(|others| others.find_ignoring_case(path))
    }
}

/// The name that a source uses for the file at `path`.
pub(super) fn key(path: &Path) -> String {
    let mut words: Vec<Cow<'_, str>> = Vec::new();
    for component in path.components() {
        match component {
            Component::CurDir => {}
            Component::ParentDir if words.last().is_some_and(|word| word != "..") => {
                words.pop();
            }
            // The root is an empty word, so that an absolute path begins with a slash.
            Component::RootDir => words.push(Cow::Borrowed("")),
            other => words.push(other.as_os_str().to_string_lossy()),
        }
    }
    words.join("/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_normalized() {
        for (path, spelled) in [
            ("a.glb", "a.glb"),
            ("./a.glb", "a.glb"),
            ("b/./c//a.glb", "b/c/a.glb"),
            ("b/../a.glb", "a.glb"),
            ("../a.glb", "../a.glb"),
            ("../../a.glb", "../../a.glb"),
            ("/b/a.glb", "/b/a.glb"),
        ] {
            assert_eq!(key(Path::new(path)), spelled);
        }
    }
}
