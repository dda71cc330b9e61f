//! The one table of everything that can be set about a rendering.
//!
//! Each row says of a setting its names, group, unit, range, meaning, what is made again when it changes, and how it is
//! read and written. Validation, options of command lines, consoles, panels, scripts, reports and declarations for
//! JavaScript are all made from it; [`Parameter::default`] computes what a preset gives. Rows live where the settings do:
//! those of the cones in [`TraceSettings::SETTINGS`] and [`ReportCones::SETTINGS`], those of VXCT's look in
//! [`VxctSettings::SETTINGS`], all others in `table.rs`.

mod choices;
mod table;

use std::fmt;
use std::sync::LazyLock;

use lumivox::TraceSettings;
pub use lumivox::settings::{Choice, Choices, Kind, Redoes, Setting, SettingError, Value};

pub(crate) use table::MAX_STOPS;

use crate::classics::ReportCones;
use crate::{Look, PresetChoice, RenderSettings, VxctSettings};

/// One setting of a rendering: a row of the table.
pub struct Parameter {
    /// Its name in lower case, words joined by `_`.
    pub name: &'static str,
    /// Other names.
    pub aliases: &'static [&'static str],
    /// The group that it is shown in.
    pub group: Group,
    /// The unit of its numbers; empty where there is none.
    pub unit: &'static str,
    /// Its meaning, in one sentence without a full stop.
    pub summary: &'static str,
    /// More about it, in sentences. It may be empty.
    pub help: &'static str,
    /// Which values there are.
    pub kind: Kind,
    /// Words that mean one of its values each.
    pub shorthands: &'static [(&'static str, Value)],
    /// The setting that must have a certain value for this one to mean anything, and that value. Setting this one sets
    /// that one, too.
    pub needs: Option<(&'static str, &'static str)>,
    /// What is made again when it changes.
    pub redoes: Redoes,
    access: Access,
}

/// The part of the settings that a row reads and writes.
enum Access {
    Own(Setting<RenderSettings>),
    Trace(Setting<TraceSettings>),
    Report(Setting<ReportCones>),
    Vxct(Setting<VxctSettings>),
}

/// What settings belong to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Group {
    /// Size of the mean, exposure, curve.
    Picture,
    /// What is shown.
    View,
    /// What is drawn over the picture.
    Overlay,
    /// Voxels and where they are stored.
    Volume,
    /// Light in the voxels, and shadows.
    Light,
    /// The cones of the physical look.
    Cones,
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
            Self::Overlay => "overlay",
            Self::Volume => "volume",
            Self::Light => "light",
            Self::Cones => "cones",
            Self::Vxct => "vxct",
        }
    }
}

/// The table, group by group.
pub static PARAMETERS: LazyLock<Vec<Parameter>> = LazyLock::new(|| {
    let own = |group: Group, rows: &[Setting<RenderSettings>]| -> Vec<Parameter> {
        rows.iter().map(|row| Parameter::new(group, row, Access::Own(*row))).collect()
    };
    let cones = TraceSettings::SETTINGS;
    let report = ReportCones::SETTINGS;
    let vxct = VxctSettings::SETTINGS;
    [
        own(Group::Picture, table::PICTURE),
        own(Group::View, table::VIEW),
        own(Group::Overlay, table::OVERLAY),
        own(Group::Volume, table::VOLUME),
        own(Group::Light, table::LIGHT),
        cones.map(|row| Parameter::new(Group::Cones, &row, Access::Trace(row))).into(),
        report.map(|row| Parameter::new(Group::Cones, &row, Access::Report(row))).into(),
        own(Group::Vxct, table::LOOK),
        vxct.map(|row| Parameter::new(Group::Vxct, &row, Access::Vxct(row))).into(),
    ]
    .into_iter()
    .flatten()
    .collect()
});

impl Parameter {
    fn new<S>(group: Group, row: &Setting<S>, access: Access) -> Self {
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
            access,
        }
    }

    /// The parameter of a name or an alias.
    pub fn find(name: &str) -> Option<&'static Self> {
        PARAMETERS.iter().find(|parameter| parameter.names().any(|known| known == name))
    }

    /// Its name and its aliases.
    pub fn names(&self) -> impl Iterator<Item = &'static str> {
        [self.name].into_iter().chain(self.aliases.iter().copied())
    }

    /// Its value in some settings.
    pub fn get(&self, settings: &RenderSettings) -> Value {
        match &self.access {
            Access::Own(row) => (row.get)(settings),
            Access::Trace(row) => (row.get)(&settings.trace),
            Access::Report(row) => (row.get)(&settings.report_cones),
            Access::Vxct(row) => (row.get)(&vxct(settings)),
        }
    }

    /// The value that a preset gives it.
    pub fn default(&self, preset: PresetChoice) -> Value {
        self.get(&RenderSettings::default().with_preset(preset, None))
    }

    /// Puts a value into settings.
    ///
    /// # Errors
    /// [`SettingError`] when it is not one of this parameter's; then nothing changes. Values that only a device or a
    /// combination forbids are found by [`RenderSettings::validate`].
    pub fn set(&self, settings: &mut RenderSettings, value: Value) -> Result<(), SettingError> {
        if !self.kind.allows(value) {
            return Err(self.error(&value.to_string()));
        }
        self.write(settings, value);
        Ok(())
    }

    fn write(&self, settings: &mut RenderSettings, value: Value) {
        match &self.access {
            Access::Own(row) => (row.set)(settings, value),
            Access::Trace(row) => (row.set)(&mut settings.trace, value),
            Access::Report(row) => (row.set)(&mut settings.report_cones, value),
            Access::Vxct(row) => {
                let mut look = vxct(settings);
                (row.set)(&mut look, value);
                settings.look = Look::Vxct(look);
            }
        }
    }

    /// Reads a value as text: a number, a choice's name, `on` or `off`, the word for a value that has no number.
    ///
    /// # Errors
    /// [`SettingError`], which says what would have been right.
    pub fn parse(&self, text: &str) -> Result<Value, SettingError> {
        let value = self.kind.parse(text, self.unit).ok_or_else(|| self.error(text))?;
        if self.kind.allows(value) { Ok(value) } else { Err(self.error(text)) }
    }

    /// Whether it means something in these settings: an option of the octree does only where there is one.
    pub fn means_something(&self, settings: &RenderSettings) -> bool {
        self.needs.is_none_or(|(name, value)| {
            Self::find(name).is_some_and(|needed| needed.get(settings).name() == value)
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

/// The settings of VXCT's look, or those that it would have.
fn vxct(settings: &RenderSettings) -> VxctSettings {
    match settings.look {
        Look::Vxct(vxct) => vxct,
        Look::Physical => VxctSettings::for_resolution(settings.resolution),
    }
}

#[cfg(test)]
mod tests;
