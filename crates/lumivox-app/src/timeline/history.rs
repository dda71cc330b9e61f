//! The light that a picture of a sequence takes over from those before it.

use clap::builder::TypedValueParser;
use lumivox_console::values::choices::among;

/// The light that a picture of a sequence takes over from those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum History {
    /// Light of earlier frames, where the settings keep it: a film as a viewer sees it while it runs.
    Kept,
    /// Nothing: each picture is the one that is rendered by itself.
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

/// The name of a [`History`].
pub fn history() -> impl TypedValueParser<Value = History> {
    among(&[History::Kept, History::None], |history| match history {
        History::Kept => ("kept", "one frame after the other, as in the window"),
        History::None => ("none", "each picture by itself"),
    })
}
