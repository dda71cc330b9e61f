//! Settings as data: whatever shows, reads or checks settings can do so by a table of them.
//!
//! A [`Setting`] is one row of such a table: its names, its unit, its range, its meaning, what is made again when it
//! changes, and how it is read and written. [`TraceSettings::SETTINGS`](crate::TraceSettings::SETTINGS) is the table of the
//! cones. Ranges are nowhere else: [`check`] is what `validate` calls.

mod choices;
mod value;

pub use choices::Choices;
pub use value::{Choice, Kind, Value};

/// A setting of settings of the type `S`.
pub struct Setting<S: 'static> {
    /// Its name in lower case, words joined by `_`.
    pub name: &'static str,
    /// Other names, such as abbreviations.
    pub aliases: &'static [&'static str],
    /// The unit of its numbers; empty where there is none.
    pub unit: &'static str,
    /// Its meaning, in one sentence without a full stop.
    pub summary: &'static str,
    /// More about it, in sentences. It may be empty.
    pub help: &'static str,
    /// Which values there are.
    pub kind: Kind,
    /// Words that mean one of its values each, such as `isotropic`.
    pub shorthands: &'static [(&'static str, Value)],
    /// The setting that must have a certain value for this one to mean anything, and that value. Setting this one sets
    /// that one, too.
    pub needs: Option<(&'static str, &'static str)>,
    /// What is made again when it changes.
    pub redoes: Redoes,
    /// Reads it.
    pub get: fn(&S) -> Value,
    /// Writes it; the value is one that `kind` allows.
    pub set: fn(&mut S, Value),
}

impl<S> Clone for Setting<S> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<S> Copy for Setting<S> {}

impl<S> Setting<S> {
    /// A row that others are made from: a switch without a name.
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

/// What is made again when a setting changes, each with what follows from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Redoes {
    /// Nothing: it is about how a finished picture is shown.
    Nothing,
    /// The frames of the picture.
    Frames,
    /// The light in the voxels, and frames.
    Light,
    /// The textures of the picture's size, and frames.
    Targets,
    /// The voxels and all that is made of them.
    Voxels,
}

/// A value that a setting does not have.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} is {expected}; got \"{got}\"")]
pub struct SettingError {
    /// The setting.
    pub name: &'static str,
    /// Which values it has.
    pub expected: String,
    /// The value that it was given.
    pub got: String,
}

impl SettingError {
    /// `got` is not a value of a setting with this name, kind and unit.
    pub fn new(name: &'static str, kind: Kind, unit: &str, got: &str) -> Self {
        let unit = if unit.is_empty() { String::new() } else { format!(" ({unit})") };
        Self { name, expected: kind.in_words() + &unit, got: got.to_owned() }
    }
}

/// Checks settings against the ranges of their table.
///
/// # Errors
/// [`SettingError`] for the first one that is out of range.
pub fn check<S>(table: &[Setting<S>], settings: &S) -> Result<(), SettingError> {
    for row in table {
        let value = (row.get)(settings);
        if !row.kind.allows(value) {
            return Err(SettingError::new(row.name, row.kind, row.unit, &value.to_string()));
        }
    }
    Ok(())
}
