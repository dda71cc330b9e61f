//! Every setting of a rendering by name: what consoles, panels and scripts are made of.
//!
//! One table says of each setting its name, unit, range and meaning, and how it is read and written. Names are those of
//! the command line, with `_` for `-`; in values either is read. What a value means in detail is said at the field of [`RenderSettings`] or of
//! [`lumivox::TraceSettings`].

mod names;
mod table;
mod value;
mod vxct;

use std::fmt;

use crate::RenderSettings;
pub use table::PARAMETERS;
pub use value::{Kind, Value};

/// One setting.
#[derive(Clone, Copy)]
pub struct Parameter {
    /// Its name in lower case, words joined by `_`.
    pub name: &'static str,
    /// What it belongs to.
    pub group: Group,
    /// The unit of its numbers; empty where there is none.
    pub unit: &'static str,
    /// What it is, in one sentence without a full stop.
    pub summary: &'static str,
    /// Which values there are.
    pub kind: Kind,
    get: fn(&RenderSettings) -> Value,
    set: fn(&mut RenderSettings, Value),
}

/// What settings belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Size of the mean, exposure, curve.
    Picture,
    /// What is shown.
    View,
    /// Voxels and where they are stored.
    Volume,
    /// Light in the voxels, and shadows.
    Light,
    /// The cones of the physical look.
    Cones,
    /// What is drawn over the picture.
    Overlay,
    /// Which look, and all of VXCT's.
    Vxct,
}

impl Group {
    /// All groups, in the order of the table.
    pub const ALL: [Self; 7] = [
        Self::Picture,
        Self::View,
        Self::Overlay,
        Self::Volume,
        Self::Light,
        Self::Cones,
        Self::Vxct,
    ];

    /// The group's name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::View => "view",
            Self::Volume => "volume",
            Self::Light => "light",
            Self::Cones => "cones",
            Self::Overlay => "overlay",
            Self::Vxct => "vxct",
        }
    }
}

/// A text that is no value of a parameter.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{name} is {expected}; got \"{got}\"")]
pub struct ParameterError {
    /// The parameter.
    pub name: &'static str,
    /// What would have been right.
    pub expected: String,
    /// What was there.
    pub got: String,
}

impl Parameter {
    /// The parameter of a name.
    pub fn find(name: &str) -> Option<&'static Self> {
        PARAMETERS.iter().find(|parameter| parameter.name == name)
    }

    /// Its value in some settings.
    pub fn get(&self, settings: &RenderSettings) -> Value {
        (self.get)(settings)
    }

    /// Puts a value into settings.
    ///
    /// # Errors
    /// [`ParameterError`] when it is none of this parameter's; then nothing changes. Values that only a device or a
    /// combination forbids are found by [`RenderSettings::validate`].
    pub fn set(&self, settings: &mut RenderSettings, value: Value) -> Result<(), ParameterError> {
        if !self.kind.allows(value) {
            return Err(self.error(&value.to_string()));
        }
        (self.set)(settings, value);
        Ok(())
    }

    /// Reads a value as text: a number, a choice's name, `on` or `off`, the word for what has no number.
    ///
    /// # Errors
    /// [`ParameterError`], which says what would have been right.
    pub fn parse(&self, text: &str) -> Result<Value, ParameterError> {
        let value = self.kind.parse(text).ok_or_else(|| self.error(text))?;
        if self.kind.allows(value) { Ok(value) } else { Err(self.error(text)) }
    }

    fn error(&self, got: &str) -> ParameterError {
        let unit = if self.unit.is_empty() { String::new() } else { format!(" ({})", self.unit) };
        let expected = self.kind.in_words() + &unit;
        ParameterError { name: self.name, expected, got: got.to_owned() }
    }
}

impl fmt::Debug for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parameter").field("name", &self.name).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
