//! A scene's files in memory: dropped on a page, or fetched one after the other.

use std::borrow::Cow;
use std::cell::RefCell;
use std::collections::{BTreeMap, BTreeSet};
use std::io;

use lumivox_scene::{EXTENSIONS, FileSource, extensions_in_words};

use crate::error::WebError;

/// The extensions of panoramas that no scene uses for textures.
const PANORAMAS: [&str; 3] = ["hdr", "exr", "pic"];

/// Files by their paths, separated by `/`. Requests for missing files are recorded.
#[derive(Debug, Default)]
pub struct Files {
    files: BTreeMap<String, Vec<u8>>,
    missing: RefCell<BTreeSet<String>>,
}

impl Files {
    /// Adds a file; one of the same path is replaced.
    pub fn add(&mut self, path: &str, bytes: Vec<u8>) {
        self.files.insert(path.trim_start_matches('/').to_owned(), bytes);
    }

    /// The missing files that a loader has requested since the last call, in order.
    pub fn take_missing(&self) -> Vec<String> {
        std::mem::take(&mut *self.missing.borrow_mut()).into_iter().collect()
    }

    /// The bytes of a file.
    pub fn get(&self, path: &str) -> Option<&[u8]> {
        self.files.get(path).map(Vec::as_slice)
    }

    /// The scene's file. Among several formats, VXCT's come first, since its scenes name geometry
    /// files; the others have the order of [`EXTENSIONS`].
    ///
    /// # Errors
    /// When there is no scene, or several.
    pub fn scene(&self) -> Result<&str, WebError> {
        let of = |extension: &str| -> Vec<&str> {
            let has_it = |path: &&String| {
                let found = path.rsplit_once('.').map(|(_, found)| found.to_ascii_lowercase());
                found.as_deref() == Some(extension)
            };
            let all: Vec<&str> = self.files.keys().filter(has_it).map(String::as_str).collect();
            // A text file beside a model may be a readme.
            let is_one = |path: &&str| extension != "txt" || self.is_text_of_scene(path);
            if self.files.len() == 1 { all } else { all.into_iter().filter(is_one).collect() }
        };
        let of_vxct = ["scene", "vxct", "txt"];
        let others = EXTENSIONS.iter().copied().filter(|extension| !of_vxct.contains(extension));
        let mut found = of_vxct.into_iter().chain(others).map(of);
        match found.find(|paths| !paths.is_empty()).as_deref() {
            Some([scene]) => Ok(scene),
            Some(several) => Err(WebError::value(format!(
                "there are several scenes: {}; open one at a time, with its files",
                several.join(", ")
            ))),
            None => {
                let names: Vec<&str> = self.files.keys().take(8).map(String::as_str).collect();
                Err(WebError::value(format!(
                    "none of these is a scene: {}; open a {} file, with the files that it names",
                    names.join(", "),
                    extensions_in_words()
                )))
            }
        }
    }

    /// Whether the first word `scene` is followed by `{` or `=`, as in VXCT's scenes.
    fn is_text_of_scene(&self, path: &str) -> bool {
        let text = String::from_utf8_lossy(self.get(path).unwrap_or_default());
        let mut words = text.split_ascii_whitespace();
        words.any(|word| word == "scene") && matches!(words.next(), Some("{" | "="))
    }

    /// The panorama, if there is one: a single file, or a file of a format that textures do not
    /// use.
    ///
    /// # Errors
    /// When there are several.
    pub fn panorama(&self) -> Result<Option<&str>, WebError> {
        let is_one = |path: &&String| {
            let extension = path.rsplit_once('.').map(|(_, found)| found.to_ascii_lowercase());
            extension.is_some_and(|extension| PANORAMAS.contains(&extension.as_str()))
        };
        let found: Vec<&str> = self.files.keys().filter(is_one).map(String::as_str).collect();
        match (found.as_slice(), self.scene()) {
            ([panorama], _) => Ok(Some(panorama)),
            ([], Err(_)) if self.files.len() == 1 => {
                Ok(self.files.keys().next().map(String::as_str))
            }
            ([], _) => Ok(None),
            (several, _) => Err(WebError::value(format!(
                "there are several panoramas: {}; open one at a time",
                several.join(", ")
            ))),
        }
    }

    /// The error that no file is a panorama.
    pub fn no_panorama(&self) -> WebError {
        let names: Vec<&str> = self.files.keys().take(8).map(String::as_str).collect();
        WebError::value(format!(
            "none of these is a panorama: {}; open a .hdr or .exr file",
            names.join(", ")
        ))
    }

    /// The file at this path, or else a file of this name without a folder: file dialogs give no
    /// folders.
    fn find(&self, path: &str) -> Option<&Vec<u8>> {
        if let Some(bytes) = self.files.get(path) {
            return Some(bytes);
        }
        let name = |path: &str| path.rsplit('/').next().unwrap_or(path).to_owned();
        let wanted = name(path);
        let mut alike =
            self.files.iter().filter(|(path, _)| !path.contains('/') && **path == wanted);
        alike.next().map(|(_, bytes)| bytes)
    }
}

impl FileSource for Files {
    fn read(&self, path: &str) -> io::Result<Cow<'_, [u8]>> {
        self.find(path).map(|bytes| Cow::Borrowed(bytes.as_slice())).ok_or_else(|| {
            self.missing.borrow_mut().insert(path.to_owned());
            io::Error::new(io::ErrorKind::NotFound, "the file is not among those that were opened")
        })
    }

    fn find_ignoring_case(&self, path: &str) -> Option<String> {
        let wanted = path.to_lowercase();
        self.files.keys().find(|path| path.to_lowercase() == wanted).cloned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(paths: &[&str]) -> Files {
        let mut files = Files::default();
        for path in paths {
            files.add(path, path.as_bytes().to_vec());
        }
        files
    }

    #[test]
    fn the_scene_among_files_is_found() {
        assert_eq!(
            of(&["a/wood.png", "a/room.gltf", "a/room.bin"]).scene().as_deref(),
            Ok("a/room.gltf")
        );
        assert_eq!(of(&["room.mtl", "readme.txt", "room.OBJ"]).scene().as_deref(), Ok("room.OBJ"));
        let several = of(&["a.glb", "b.glb"]).scene().unwrap_err();
        assert!(several.message.contains("a.glb, b.glb"), "{several}");
        let none = of(&["wood.png"]).scene().unwrap_err();
        assert!(none.message.contains("wood.png") && none.message.contains(".glb"), "{none}");
    }

    #[test]
    fn vxct_scenes_take_precedence_over_models() {
        let mut files = of(&["box.obj", "quad.obj"]);
        files.add("room.scene", b"scene { }".to_vec());
        assert_eq!(files.scene(), Ok("room.scene"));
        let mut files = of(&["box.obj"]);
        files.add("room.txt", b"\nscene = { name = room }".to_vec());
        assert_eq!(files.scene(), Ok("room.txt"));
        let mut files = of(&["box.obj"]);
        files.add("readme.txt", b"A box for every scene.".to_vec());
        assert_eq!(files.scene(), Ok("box.obj"));
        // A single file is the scene; its loader reports its errors.
        let mut files = Files::default();
        files.add("readme.txt", b"A box.".to_vec());
        assert_eq!(files.scene(), Ok("readme.txt"));
    }

    #[test]
    fn the_panorama_among_files_is_found() {
        let found = |paths: &[&str]| of(paths).panorama().map(|found| found.map(str::to_owned));
        assert_eq!(found(&["hall.HDR"]), Ok(Some("hall.HDR".to_owned())));
        assert_eq!(found(&["room.glb", "sky/day.exr"]), Ok(Some("sky/day.exr".to_owned())));
        // A single picture is a panorama; beside a scene it is a texture.
        assert_eq!(found(&["hall.jpg"]), Ok(Some("hall.jpg".to_owned())));
        assert_eq!(found(&["room.obj", "wood.jpg"]), Ok(None));
        assert_eq!(found(&["room.glb"]), Ok(None));
        let several = found(&["room.glb", "a.hdr", "b.exr"]).unwrap_err();
        assert!(several.message.contains("a.hdr, b.exr"), "{several}");
        assert!(of(&["a.jpg", "b.txt"]).no_panorama().message.contains("a.jpg, b.txt"));
    }

    #[test]
    fn files_without_folders_are_found_by_their_names() {
        let files = of(&["room.gltf", "wood.png", "b/stone.png"]);
        assert_eq!(files.read("textures/wood.png").unwrap().as_ref(), b"wood.png");
        assert_eq!(files.read("b/stone.png").unwrap().as_ref(), b"b/stone.png");
        // Files in folders need the whole path.
        assert!(files.read("c/stone.png").is_err());
        assert_eq!(files.take_missing(), ["c/stone.png"]);
        assert!(files.take_missing().is_empty());
        assert_eq!(files.find_ignoring_case("B/Stone.PNG").as_deref(), Some("b/stone.png"));
    }
}
