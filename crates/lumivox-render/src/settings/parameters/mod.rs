//! The table of all settings of a rendering.
//!
//! Each row describes a setting: its names, group, unit, range, meaning, the work that a change
//! redoes, and how it is read and written. Validation, command-line options, consoles, panels,
//! scripts, reports and declarations for JavaScript are all generated from it;
//! [`Parameter::default`] computes the value in a preset. Rows are defined next to the settings:
//! those of the cones in [`TraceSettings::SETTINGS`], all others of this crate in `table.rs`. A
//! [look](crate::look) and the library's [hooks](lumivox::hooks) have rows of their own, made by
//! [`Parameter::own`] and [`Parameter::of_part`]; the program that offers them adds their rows,
//! like `lumivox-explorer`.

mod choices;
mod table;

use std::fmt;
use std::sync::{Arc, LazyLock};

use lumivox::TraceSettings;
pub use lumivox::settings::{Choice, Choices, Kind, Redoes, Setting, SettingError, Value};

pub use table::MAX_STOPS;

use crate::{PresetChoice, RenderSettings};

/// One setting of a rendering: a row of the table.
#[derive(Clone)]
pub struct Parameter {
    /// Its name in lower case, words joined by `_`.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// The group that shows it.
    pub group: Group,
    /// The unit of its numbers; empty if it has none.
    pub unit: &'static str,
    /// Its meaning, in one sentence without a full stop.
    pub summary: &'static str,
    /// Further explanation in sentences; may be empty.
    pub help: &'static str,
    /// The kind and range of its values.
    pub kind: Kind,
    /// Words that set particular values.
    pub shorthands: &'static [(&'static str, Value)],
    /// Another setting, and its value without which this one has no effect. Setting this one also
    /// sets the other.
    pub needs: Option<(&'static str, &'static str)>,
    /// The work that a change redoes.
    pub redoes: Redoes,
    get: Arc<Get>,
    set: Arc<Set>,
}

type Get = dyn Fn(&RenderSettings) -> Value + Send + Sync;
type Set = dyn Fn(&mut RenderSettings, Value) + Send + Sync;

/// A group of settings.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Number of frames, exposure, curve.
    Picture,
    /// The view.
    View,
    /// The overlay.
    Overlay,
    /// Voxels and where they are stored.
    Volume,
    /// Light in the voxels, and shadows.
    Light,
    /// The cones of the physical look.
    Cones,
    /// Settings of a look, by its name.
    Look(&'static str),
}

impl Group {
    /// The groups of this crate's table, in its order; looks have groups of their own.
    pub const ALL: [Self; 6] =
        [Self::Picture, Self::View, Self::Overlay, Self::Volume, Self::Light, Self::Cones];

    /// The group's name in lower case.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Picture => "picture",
            Self::View => "view",
            Self::Overlay => "overlay",
            Self::Volume => "volume",
            Self::Light => "light",
            Self::Cones => "cones",
            Self::Look(name) => name,
        }
    }
}

/// The table of this crate's settings, group by group.
pub static PARAMETERS: LazyLock<Vec<Parameter>> = LazyLock::new(|| {
    let own = |group: Group, rows: &[Setting<RenderSettings>]| -> Vec<Parameter> {
        rows.iter().map(|row| Parameter::own(group, *row)).collect()
    };
    let cones = TraceSettings::SETTINGS;
    let of_cones =
        |row| Parameter::of_part(Group::Cones, row, |s| s.trace, |s, trace| s.trace = trace);
    [
        own(Group::Picture, table::PICTURE),
        own(Group::View, table::VIEW),
        own(Group::Overlay, table::OVERLAY),
        own(Group::Volume, table::VOLUME),
        own(Group::Light, table::LIGHT),
        cones.iter().copied().map(of_cones).collect(),
    ]
    .into_iter()
    .flatten()
    .collect()
});

impl Parameter {
    /// A row whose setting is in [`RenderSettings`] itself.
    pub fn own(group: Group, row: Setting<RenderSettings>) -> Self {
        Self::new(group, &row, Arc::new(row.get), Arc::new(row.set))
    }

    /// A row whose setting is in a part of the settings, which is read and written as a whole.
    pub fn of_part<S>(
        group: Group,
        row: Setting<S>,
        part: fn(&RenderSettings) -> S,
        put: fn(&mut RenderSettings, S),
    ) -> Self {
        let get = move |settings: &RenderSettings| (row.get)(&part(settings));
        let set = move |settings: &mut RenderSettings, value| {
            let mut changed = part(settings);
            (row.set)(&mut changed, value);
            put(settings, changed);
        };
        Self::new(group, &row, Arc::new(get), Arc::new(set))
    }

    fn new<S>(group: Group, row: &Setting<S>, get: Arc<Get>, set: Arc<Set>) -> Self {
        Self {
            name: row.name,
            aliases: row.aliases,
            group,
            unit: row.unit,
            summary: row.summary,
            help: row.help,
            kind: row.kind,
            shorthands: row.shorthands,
            needs: row.needs,
            redoes: row.redoes,
            get,
            set,
        }
    }

    /// The row of a name or an alias in this crate's table.
    pub(crate) fn find(name: &str) -> Option<&'static Self> {
        PARAMETERS.iter().find(|parameter| parameter.names().any(|known| known == name))
    }

    /// The name and its aliases.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        [self.name].into_iter().chain(self.aliases.iter().copied())
    }

    /// The setting's value in `settings`.
    pub fn get(&self, settings: &RenderSettings) -> Value {
        (self.get)(settings)
    }

    /// The setting's value in a preset.
    pub fn default(&self, preset: PresetChoice) -> Value {
        self.get(&RenderSettings::default().with_preset(preset, None))
    }

    /// Writes a value into settings.
    ///
    /// # Errors
    /// [`SettingError`] when the value is not allowed; then nothing changes.
    /// [`RenderSettings::validate`] finds values that only a device or a combination forbids.
    pub fn set(&self, settings: &mut RenderSettings, value: Value) -> Result<(), SettingError> {
        if !self.kind.allows(value) {
            return Err(self.error(&value.to_string()));
        }
        self.write(settings, value);
        Ok(())
    }

    fn write(&self, settings: &mut RenderSettings, value: Value) {
        (self.set)(settings, value);
    }

    /// Parses a value: a number, a choice's name, `on` or `off`, or a word for no number, such as
    /// `auto`.
    ///
    /// # Errors
    /// [`SettingError`], which lists the allowed values.
    pub fn parse(&self, text: &str) -> Result<Value, SettingError> {
        let value = self.kind.parse(text, self.unit).ok_or_else(|| self.error(text))?;
        if self.kind.allows(value) { Ok(value) } else { Err(self.error(text)) }
    }

    /// Whether the setting has an effect in `settings`: options of the octree need an octree.
    pub fn means_something(&self, settings: &RenderSettings) -> bool {
        self.needs.is_none_or(|(name, value)| match name {
            "look" => settings.look_name() == value,
            name => Self::find(name).is_some_and(|needed| needed.get(settings).name() == value),
        })
    }

    pub(super) fn error(&self, got: &str) -> SettingError {
        SettingError::new(self.name, self.kind, self.unit, got)
    }
}

impl fmt::Debug for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Parameter").field("name", &self.name).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod tests;
