//! The light that a picture of a sequence takes over from those before it.

use clap::builder::TypedValueParser;
use lumivox_console::values::choices::among;

/// The light that a picture of a sequence takes over from those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum History {
    /// Light of earlier frames, if the settings keep it: pictures look as in the running window.
    Kept,
    /// Nothing: each picture is as if rendered on its own.
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
