//! Which scene.

use std::fmt;
use std::path::PathBuf;

/// The prefix of the names of scenes that are made in code.
pub const BUILTIN: &str = "builtin:";

/// A scene, as people name it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneSource {
    /// One made in code.
    Builtin(String),
    /// A file.
    File(PathBuf),
}

impl SceneSource {
    /// The scene of that name: one that is made in code, or a file.
    pub fn named(text: &str) -> Self {
        match text.strip_prefix(BUILTIN) {
            Some(name) => Self::Builtin(name.to_owned()),
            None => Self::File(text.into()),
        }
    }
}

impl fmt::Display for SceneSource {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Builtin(name) => write!(f, "{BUILTIN}{name}"),
            Self::File(file) => file.display().fmt(f),
        }
    }
}
