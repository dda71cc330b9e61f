//! Settings as data: a table used to show, parse and check settings.
//!
//! A [`Setting`] is one row of such a table: its names, unit, range and meaning, the work that a
//! change redoes, and its accessors. [`TraceSettings::SETTINGS`](crate::TraceSettings::SETTINGS) is
//! the table of the cones. Ranges are defined only there: `validate` calls [`check`].

mod choices;
mod value;

pub use choices::Choices;
pub use value::{Choice, Kind, Value};

/// A row: one setting of the type `S`.
pub struct Setting<S: 'static> {
    /// The name in lower case, words joined by `_`.
    pub name: &'static str,
    /// Other names, such as abbreviations.
    pub aliases: &'static [&'static str],
    /// The unit of numbers; empty if there is none.
    pub unit: &'static str,
    /// The setting's meaning, in one sentence without a full stop.
    pub summary: &'static str,
    /// More details, in sentences; may be empty.
    pub help: &'static str,
    /// The kind and range of its values.
    pub kind: Kind,
    /// Words that each set one of its values, such as `isotropic`.
    pub shorthands: &'static [(&'static str, Value)],
    /// Another setting and the value that it must have for this one to have an effect. Setting this
    /// one also sets the other.
    pub needs: Option<(&'static str, &'static str)>,
    /// The work that a change redoes.
    pub redoes: Redoes,
    /// Reads the value.
    pub get: fn(&S) -> Value,
    /// Writes the value, which `kind` must allow.
    pub set: fn(&mut S, Value),
}

impl<S> Clone for Setting<S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for Setting<S> {}

impl<S> Setting<S> {
    /// Template for other rows: a switch without a name.
    pub const ROW: Self = Self {
        name: "",
        aliases: &[],
        unit: "",
        summary: "",
        help: "",
        kind: Kind::Switch,
        shorthands: &[],
        needs: None,
        redoes: Redoes::Nothing,
        get: |_| Value::Switch(false),
        set: |_, _| {},
    };
}

/// The work to redo after a setting has changed, including everything that depends on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Redoes {
    /// Nothing: the setting only changes how a finished picture is shown.
    Nothing,
    /// The frames of the picture.
    Frames,
    /// The light in the voxels, and frames.
    Light,
    /// With a cone model, the voxels' light, which its cones gather, and frames; without one, only
    /// frames.
    MarchedLight,
    /// The textures that are as large as the picture, and the frames.
    Targets,
    /// The voxels and everything made from them.
    Voxels,
}

/// Error: a setting cannot have this value.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} is {expected}; got \"{got}\"")]
pub struct SettingError {
    /// The setting.
    pub name: &'static str,
    /// The allowed values.
    pub expected: String,
    /// The given value.
    pub got: String,
}

impl SettingError {
    /// The error for the value `got` of a setting with this name, kind and unit.
    pub fn new(name: &'static str, kind: Kind, unit: &str, got: &str) -> Self {
        let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        Self { name, expected: kind.in_words() + &unit, got: got.to_owned() }
    }
}

/// Checks settings against the ranges of their table.
///
/// # Errors
/// [`SettingError`] for the first setting that is out of range.
pub fn check<S>(table: &[Setting<S>], settings: &S) -> Result<(), SettingError> {
    for row in table {
        let value = (row.get)(settings);
        if !row.kind.allows(value) {
            return Err(SettingError::new(row.name, row.kind, row.unit, &value.to_string()));
        }
    }
    Ok(())
}
