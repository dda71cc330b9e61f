//! The light that pictures of a sequence reuse from earlier ones.

use clap::builder::TypedValueParser;
use lumivox_console::values::choices::among;

/// The light that pictures of a sequence reuse from earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum History {
    /// Light of earlier frames, if the settings keep it, as in the window.
    Kept,
    /// None: each picture is as if rendered on its own.
    None,
}

impl History {
    /// The name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Kept => "kept",
            Self::None => "none",
        }
    }
}

/// Parses the name of a [`History`].
pub fn history() -> impl TypedValueParser<Value = History> {
    among(&[History::Kept, History::None], |history| match history {
        History::Kept => ("kept", "one frame after the other, as in the window"),
        History::None => ("none", "each picture by itself"),
    })
}
