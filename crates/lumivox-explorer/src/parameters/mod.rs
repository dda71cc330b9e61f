//! The one table of settings, and the presets.
//!
//! The renderer has settings and presets; crates that use its hooks and the library's have more.
//! This module makes them one table, which all front ends read. The feature `classics` decides
//! whether the renderers from the literature are included (`classics.rs`).

#[cfg(feature = "classics")]
mod classics;

use std::sync::LazyLock;

use lumivox_render::PresetChoice;
use lumivox_render::parameters::PARAMETERS as OF_RENDERER;
pub use lumivox_render::parameters::{
    Choice, Choices, Group, Kind, Parameter, Redoes, Setting, SettingError, Value,
};

/// The table, group by group.
pub static PARAMETERS: LazyLock<Vec<Parameter>> = LazyLock::new(table);

/// The groups of the table, in its order.
pub const GROUPS: &[Group] = &[
    Group::Picture,
    Group::View,
    Group::Overlay,
    Group::Volume,
    Group::Light,
    Group::Cones,
    #[cfg(feature = "classics")]
    lumivox_vxct::GROUP,
];

/// All presets, from the cheapest to the most expensive, then those that are not physical.
pub const PRESETS: &[PresetChoice] = &[
    PresetChoice::ALL[0],
    PresetChoice::ALL[1],
    PresetChoice::ALL[2],
    PresetChoice::ALL[3],
    #[cfg(feature = "classics")]
    classics::REPORT,
    #[cfg(feature = "classics")]
    lumivox_vxct::PRESET,
];

/// A program whose commands the console has under the same names.
#[derive(Clone, Copy, Debug)]
pub struct OtherConsole {
    /// The program.
    pub program: &'static str,
    /// The look whose settings are commands, too.
    pub look: &'static str,
    /// Each command, and how it differs here; empty if it does not.
    pub commands: &'static [(&'static str, &'static str)],
}

/// The programs whose commands the console has.
pub const OTHER_CONSOLES: &[OtherConsole] = &[
    #[cfg(feature = "classics")]
    OtherConsole { program: "VXCT", look: lumivox_vxct::NAME, commands: lumivox_vxct::COMMANDS },
];

/// The presets of the physical look: their pictures are in physical units, and can be compared with
/// references.
pub const PRESETS_TO_MEASURE: &[PresetChoice] = &[
    PresetChoice::ALL[0],
    PresetChoice::ALL[1],
    PresetChoice::ALL[2],
    PresetChoice::ALL[3],
    #[cfg(feature = "classics")]
    classics::REPORT,
];

/// The parameter of a name or an alias.
pub fn find_parameter(name: &str) -> Option<&'static Parameter> {
    PARAMETERS.iter().find(|parameter| parameter.names().any(|known| known == name))
}

/// The preset of a name.
pub fn find_preset(name: &str) -> Option<PresetChoice> {
    PRESETS.iter().copied().find(|preset| preset.name() == name)
}

/// The renderer's rows, and those of the classics in their groups.
fn table() -> Vec<Parameter> {
    #[allow(unused_mut)] // Without classics it is the renderer's.
    let mut table = OF_RENDERER.clone();
    #[cfg(feature = "classics")]
    for (row, before) in classics::rows() {
        let named = before.and_then(|name| table.iter().position(|row| row.name == name));
        let in_group = table.iter().rposition(|other| other.group == row.group);
        let place = named.or(in_group.map(|last| last + 1)).unwrap_or(table.len());
        table.insert(place, row);
    }
    table
}

#[cfg(all(test, feature = "classics"))]
mod tests;
