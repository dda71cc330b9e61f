//! The source of a scene.

use std::fmt;
use std::path::PathBuf;

/// The prefix of the names of built-in scenes.
pub const BUILTIN: &str = "builtin:";

/// A scene as users name it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum SceneSource {
    /// A built-in scene.
    Builtin(String),
    /// A file.
    File(PathBuf),
}

impl SceneSource {
    /// The scene of that name: a built-in one, or a file.
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
